import { OneBlob } from "../../field/encodings/one-blob.js";
import type { EncodingShader } from "./encoding-shader.js";

export const oneBlobShader: EncodingShader<OneBlob> = {
  type: OneBlob.type,
  piece: "one-blob",
  function: "irradia_one_blob",
  record: ({ nBins }, { firstColumn }) => [[firstColumn, nBins, 0, 0]],
  /** The integral of a bump at every edge of a bin. */
  cost: ({ nOutputs }) => ({ flops: 6 * nOutputs, fetches: 0 }),
};
