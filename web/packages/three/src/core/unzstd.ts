/** Zstandard by the decoder that three.js' KTX2Loader brings along. */
import type { Unzstd } from "@irradia/runtime";
import { ZSTDDecoder } from "three/addons/libs/zstddec.module.js";

/** A decoder that is ready. */
export async function readyUnzstd(): Promise<Unzstd> {
  const decoder = new ZSTDDecoder();
  await decoder.init();
  return (packed, nBytes) => decoder.decode(packed, nBytes);
}
