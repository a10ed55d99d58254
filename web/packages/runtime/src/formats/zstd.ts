/**
 * Zstandard, with a decoder of the caller's.
 *
 * This package brings none: pages with three.js already have one (`zstddec`, which its KTX2Loader uses), and
 * a second would cost them twenty kilobytes. What a frame claims to hold is checked here, before any decoder
 * is asked for memory.
 */
import { ByteReader } from "../bytes.js";
import { expect, InputError } from "../errors.js";

/** Unpacks one whole Zstandard frame to exactly `nBytes`, or throws. `ZSTDDecoder.decode` of zstddec fits. */
export type Unzstd = (packed: Uint8Array, nBytes: number) => Uint8Array;

export interface UnpackOptions {
  /** Needed only for files that are packed. */
  readonly unzstd?: Unzstd | undefined;
  /** Most bytes that may come out; more is damage, or an attack. */
  readonly maxBytes?: number | undefined;
}

export const DEFAULT_MAX_BYTES = 2 ** 30;

const MAGIC = 0xfd2fb528;
const GIVE_DECODER = "Give `unzstd`, such as zstddec's `(bytes, size) => decoder.decode(bytes, size)`.";

/** Whether bytes begin as a Zstandard frame. */
export function isZstd(bytes: Uint8Array): boolean {
  return bytes.length >= 4 && new ByteReader(bytes, "").u32(0) === MAGIC;
}

/** Unpacks a frame that states its size. */
export function unpackFrame(packed: Uint8Array, where: string, options: UnpackOptions): Uint8Array {
  return unpack(packed, frameContentBytes(packed, where), where, options);
}

/** Unpacks to so many bytes, and no others. */
export function unpack(
  packed: Uint8Array,
  nBytes: number,
  where: string,
  options: UnpackOptions,
): Uint8Array {
  const { unzstd, maxBytes = DEFAULT_MAX_BYTES } = options;
  expect(
    nBytes > 0 && nBytes <= maxBytes,
    `expected at most ${maxBytes} bytes unpacked, found ${nBytes}`,
    where,
  );
  expect(unzstd !== undefined, "it is packed by Zstandard, and there is no decoder", where, GIVE_DECODER);
  expect(frameContentBytes(packed, where, nBytes) === nBytes, "its packed data is of another size", where);
  const bytes = unpacked(unzstd, packed, nBytes, where);
  expect(bytes.length === nBytes, `expected ${nBytes} bytes unpacked, found ${bytes.length}`, where);
  return bytes;
}

function unpacked(unzstd: Unzstd, packed: Uint8Array, nBytes: number, where: string): Uint8Array {
  try {
    return unzstd(packed, nBytes);
  } catch (error) {
    throw new InputError(`it can't be unpacked: ${error instanceof Error ? error.message : error}`, where);
  }
}

/**
 * What a frame says it holds (RFC 8878, section 3.1.1.1).
 *
 * @param whenUnsaid for frames that say nothing; without it such frames are refused
 */
export function frameContentBytes(packed: Uint8Array, where: string, whenUnsaid?: number): number {
  const frame = new ByteReader(packed, where);
  expect(frame.u32(0) === MAGIC, "expected a Zstandard frame", where);
  const descriptor = frame.slice(4, 1)[0] ?? 0;
  const isSingleSegment = (descriptor & 0x20) !== 0;
  const dictionaryBytes = [0, 1, 2, 4][descriptor & 3] ?? 0;
  const at = 5 + (isSingleSegment ? 0 : 1) + dictionaryBytes;
  switch (descriptor >> 6) {
    case 0:
      if (isSingleSegment) return frame.slice(at, 1)[0] ?? 0;
      expect(whenUnsaid !== undefined, "its packed data doesn't say its size", where);
      return whenUnsaid;
    case 1: {
      const [low = 0, high = 0] = frame.slice(at, 2);
      return low + 256 * high + 256;
    }
    case 2:
      return frame.u32(at);
    default:
      return frame.u64(at);
  }
}
