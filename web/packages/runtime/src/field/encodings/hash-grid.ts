import { expect } from "../../errors.js";
import type { JsonView } from "../../json.js";
import { clamp } from "../../numbers.js";
import { cornerWeight, type Encoding, type TensorSlot, type Vec3 } from "../encoding.js";

const PRIMES: Vec3 = [1, 2654435761, 805459861];

export interface HashGridOptions {
  /** Grids. */
  nLevels: number;
  /** The most entries of a level, as a power of two. */
  log2TableSize: number;
  /** Values of an entry. */
  nFeatures: number;
  /** Of the coarsest grid. */
  baseResolution: number;
  /** Of the finest; those between grow geometrically. */
  maxResolution: number;
  /** Every level stores 2^log2TableSize entries, needed or not. */
  fullLevels: boolean;
  /** Dense levels are hashed too. */
  hashAll: boolean;
  /** `floor` has resolutions floor(b^l · base) and points at r_l · x, without the half. */
  convention: "tiny-cuda-nn" | "floor";
  /** Factors of x, y and z in the hash. */
  primes: Vec3;
}

/** One grid, as shaders want it. */
export interface HashLevel {
  /** Cells along the box, a float: a point lies at `scale * x + offset`. */
  readonly scale: number;
  readonly offset: number;
  /** Corners along an axis; the stride of dense levels. */
  readonly resolution: number;
  readonly nEntries: number;
  /** Whether corners are numbered, x fastest, or else hashed. */
  readonly dense: boolean;
}

/**
 * Multi-resolution hash grid (Müller et al. 2022, section 3) in tiny-cuda-nn's conventions; docs/fields.md
 * says where ours differ. Features of all levels, the coarsest first.
 */
export class HashGrid implements Encoding {
  static readonly type = "hash";
  readonly type = HashGrid.type;
  readonly domain = "cube";
  readonly options: Readonly<HashGridOptions>;
  readonly levels: readonly HashLevel[];
  readonly nOutputs: number;
  readonly slots: readonly TensorSlot[];

  constructor(options: HashGridOptions) {
    this.options = options;
    this.levels = Array.from({ length: options.nLevels }, (_, index) => levelOf(options, index));
    this.nOutputs = options.nLevels * options.nFeatures;
    this.slots = this.levels.map((level, index) => ({
      name: `level.${index}`,
      shape: [level.nEntries, options.nFeatures],
    }));
  }

  static read(spec: JsonView): HashGrid {
    spec.allow(KEYS);
    const baseResolution = spec.integer("base_resolution", 2, 1 << 20, 16);
    const primes = spec.numbers("primes", 3, PRIMES) as [number, number, number];
    const known = primes.every((prime) => Number.isInteger(prime) && prime > 0 && prime < 2 ** 32);
    expect(known, "expected three factors below 2^32", spec.at("primes"));
    return new HashGrid({
      nLevels: spec.integer("n_levels", 1, 32, 16),
      log2TableSize: spec.integer("log2_table_size", 3, 28, 19),
      nFeatures: spec.integer("n_features", 1, 16, 2),
      baseResolution,
      maxResolution: spec.integer("max_resolution", baseResolution, 1 << 20, 2048),
      fullLevels: spec.boolean("full_levels", false),
      hashAll: spec.boolean("hash_all", false),
      convention: spec.choice("convention", ["tiny-cuda-nn", "floor"], "tiny-cuda-nn"),
      primes,
    });
  }

  forward(x: Vec3, tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    const { nFeatures } = this.options;
    out.fill(0, first, first + this.nOutputs);
    this.levels.forEach((level, index) => {
      const table = tensors[index] as Float32Array;
      this.#eachCorner(level, x, (entry, weight) => {
        for (let f = 0; f < nFeatures; f++) {
          const place = first + index * nFeatures + f;
          out[place] = (out[place] ?? 0) + weight * (table[entry * nFeatures + f] ?? 0);
        }
      });
    });
  }

  /** Entry and weight of each corner of a point's cell. */
  #eachCorner(level: HashLevel, x: Vec3, visit: (entry: number, weight: number) => void): void {
    // scale · x + offset rounds twice, as floats do without fused multiply-add.
    const position = x.map((c) => Math.fround(Math.fround(level.scale * clamp(c, 0, 1)) + level.offset));
    const [px, py, pz] = position as [number, number, number];
    const [i, j, k] = [Math.floor(px), Math.floor(py), Math.floor(pz)];
    for (let corner = 0; corner < 8; corner++) {
      const [dx, dy, dz] = [corner & 1, (corner >> 1) & 1, corner >> 2];
      const weight = cornerWeight(dx, px - i) * cornerWeight(dy, py - j) * cornerWeight(dz, pz - k);
      visit(this.#entry(level, i + dx, j + dy, k + dz), weight);
    }
  }

  #entry(level: HashLevel, i: number, j: number, k: number): number {
    if (level.dense) return (i + level.resolution * (j + level.resolution * k)) % level.nEntries;
    const [px, py, pz] = this.options.primes;
    return ((Math.imul(i, px) ^ Math.imul(j, py) ^ Math.imul(k, pz)) >>> 0) % level.nEntries;
  }
}

const KEYS = [
  "type",
  "n_levels",
  "log2_table_size",
  "n_features",
  "base_resolution",
  "max_resolution",
  "full_levels",
  "hash_all",
  "convention",
  "primes",
];

function levelOf(options: HashGridOptions, index: number): HashLevel {
  const { baseResolution, maxResolution, nLevels } = options;
  const growth = (Math.log2(maxResolution / baseResolution) * index) / Math.max(nLevels - 1, 1);
  const cells = 2 ** growth * baseResolution;
  const isTiny = options.convention === "tiny-cuda-nn";
  // A resolution meant to be whole mustn't fall below it by rounding.
  const scale = isTiny ? Math.fround(cells - 1) : Math.floor(Math.fround(cells));
  const resolution = Math.ceil(scale) + 1; // n cells have n + 1 corners
  const most = 2 ** options.log2TableSize;
  const nEntries = options.fullLevels ? most : Math.min(Math.ceil(resolution ** 3 / 8) * 8, most);
  const dense = !options.hashAll && resolution ** 3 <= nEntries;
  return { scale, offset: isTiny ? 0.5 : 0, resolution, nEntries, dense };
}
