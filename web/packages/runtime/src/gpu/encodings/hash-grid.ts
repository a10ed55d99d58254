import { HashGrid, type HashLevel } from "../../field/encodings/hash-grid.js";
import { isPowerOfTwo } from "../../numbers.js";
import type { TableTexture } from "../field-textures.js";
import {
  type EncodingPlace,
  type EncodingShader,
  featuresPerTexel,
  halves,
  scalesOf,
  tableOf,
  type Vec4,
} from "./encoding-shader.js";

export const hashGridShader: EncodingShader<HashGrid> = {
  type: HashGrid.type,
  piece: "hash-grid",
  function: "irradia_table_hash_grid",
  record({ options, levels }, place) {
    const table = tableOf(place);
    const [x, y, z] = options.primes;
    return [
      [place.firstColumn, options.nLevels, options.nFeatures, featuresPerTexel(table)],
      listShape(table),
      [...halves(x), ...halves(y)],
      [...halves(z), 0, 0],
      ...levels.flatMap((level, index) => levelRecord(level, index, table, place)),
    ];
  },
  /** Eight corners a level, each with a weight of two products. */
  cost({ options }, place) {
    const values = 8 * options.nLevels * options.nFeatures;
    const fetches = 8 * options.nLevels * tableOf(place).entry.texelsPerEntry;
    return { flops: 2 * values + 16 * options.nLevels, fetches };
  },
};

/** All as binary logarithms; in a single layer rows never end. */
function listShape({ texture, entry }: TableTexture): Vec4 {
  const rows = texture.layers > 1 ? Math.log2(texture.height) : 31 - Math.log2(texture.width);
  return [Math.log2(texture.width), rows, Math.log2(entry.entriesPerTexel), Math.log2(entry.texelsPerEntry)];
}

function levelRecord(level: HashLevel, index: number, table: TableTexture, place: EncodingPlace): Vec4[] {
  const { scale, offset, resolution, nEntries } = level;
  const kind = level.dense ? 0 : isPowerOfTwo(nEntries) ? 1 : 2;
  const firstTexel = table.tensors[index]?.firstTexel ?? 0;
  return [
    [scale, offset, resolution, kind],
    [...halves(firstTexel), ...halves(nEntries)],
    [...scalesOf(table, index, place.firstScale), 0, 0],
  ];
}
