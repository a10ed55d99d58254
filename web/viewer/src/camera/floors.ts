/** Triangles by the squares of a plan in which they lie, so that few of them are asked about feet and walls. */

/** Triangles that a square should hold, on average. */
const PER_SQUARE = 2;
const MOST_SQUARES_A_SIDE = 1024;
/** Squares that a triangle may lie in, on average; where they are so large, so are squares. */
const MOST_SQUARES = 16;

type Xyz = readonly [x: number, y: number, z: number];

export class Floors {
  /** Nine numbers a triangle: its corners in world space. */
  readonly #corners: Float32Array;
  readonly #low: readonly [x: number, z: number];
  #side: number;
  #nX = 1;
  #nZ = 1;
  /** Where in `#members` each square's triangles begin. */
  readonly #starts: Uint32Array;
  readonly #members: Uint32Array;

  /** @param corners nine numbers a triangle, metres; +Y is up */
  constructor(corners: Float32Array) {
    this.#corners = corners;
    const count = corners.length / 9;
    const [lowX, highX] = range(corners, 0);
    const [lowZ, highZ] = range(corners, 2);
    const [width, depth] = [highX - lowX, highZ - lowZ];
    const side = Math.sqrt((width * depth * PER_SQUARE) / Math.max(count, 1));
    this.#low = [lowX, lowZ];
    this.#side = Math.max(side, Math.max(width, depth) / MOST_SQUARES_A_SIDE) || 1;
    let reaches: Uint16Array;
    for (;;) {
      this.#nX = Math.max(1, Math.ceil(width / this.#side));
      this.#nZ = Math.max(1, Math.ceil(depth / this.#side));
      reaches = this.#reaches(count);
      if (nMembers(reaches) <= MOST_SQUARES * count) break;
      this.#side *= 2;
    }
    this.#starts = startsOf(reaches, this.#nX, this.#nZ);
    this.#members = membersOf(reaches, this.#nX, this.#starts);
  }

  /**
   * Metres to the first triangle, seen from either side.
   *
   * @param direction of length 1
   * @param most metres after which nobody cares
   */
  distance(from: Xyz, direction: Xyz, most = Number.POSITIVE_INFINITY): number | undefined {
    let nearest = most;
    for (const triangle of this.#along(from, direction, most)) {
      nearest = Math.min(nearest, hit(this.#corners, 9 * triangle, from, direction));
    }
    return nearest < most ? nearest : undefined;
  }

  /** The triangles of all squares in the box about a way; all of them for none that ends. */
  *#along([x, , z]: Xyz, [dx, , dz]: Xyz, most: number): Generator<number> {
    const end = (from: number, way: number): number => (way === 0 ? from : from + way * most);
    const [firstX, lastX] = sorted(this.#column(x), this.#column(end(x, dx)));
    const [firstZ, lastZ] = sorted(this.#row(z), this.#row(end(z, dz)));
    for (let row = Math.max(firstZ, 0); row <= Math.min(lastZ, this.#nZ - 1); row += 1) {
      for (let column = Math.max(firstX, 0); column <= Math.min(lastX, this.#nX - 1); column += 1) {
        const square = row * this.#nX + column;
        const last = this.#starts[square + 1] ?? 0;
        for (let i = this.#starts[square] ?? 0; i < last; i += 1) yield this.#members[i] ?? 0;
      }
    }
  }

  /** First and last column, first and last row of each triangle. */
  #reaches(count: number): Uint16Array {
    const reaches = new Uint16Array(4 * count);
    const corners = this.#corners;
    for (let i = 0; i < count; i += 1) {
      const [ax, bx, cx] = [corners[9 * i] ?? 0, corners[9 * i + 3] ?? 0, corners[9 * i + 6] ?? 0];
      const [az, bz, cz] = [corners[9 * i + 2] ?? 0, corners[9 * i + 5] ?? 0, corners[9 * i + 8] ?? 0];
      reaches[4 * i] = Math.min(this.#column(Math.min(ax, bx, cx)), this.#nX - 1);
      reaches[4 * i + 1] = Math.min(this.#column(Math.max(ax, bx, cx)), this.#nX - 1);
      reaches[4 * i + 2] = Math.min(this.#row(Math.min(az, bz, cz)), this.#nZ - 1);
      reaches[4 * i + 3] = Math.min(this.#row(Math.max(az, bz, cz)), this.#nZ - 1);
    }
    return reaches;
  }

  #column(x: number): number {
    return Math.floor((x - this.#low[0]) / this.#side);
  }

  #row(z: number): number {
    return Math.floor((z - this.#low[1]) / this.#side);
  }
}

function nMembers(reaches: Uint16Array): number {
  let n = 0;
  for (let i = 0; i < reaches.length; i += 4) {
    const [columns, rows] = [
      (reaches[i + 1] ?? 0) - (reaches[i] ?? 0) + 1,
      (reaches[i + 3] ?? 0) - (reaches[i + 2] ?? 0) + 1,
    ];
    n += columns * rows;
  }
  return n;
}

/** Where each square's triangles begin in a list of all. */
function startsOf(reaches: Uint16Array, nX: number, nZ: number): Uint32Array {
  const starts = new Uint32Array(nX * nZ + 1);
  eachSquare(reaches, nX, (square) => {
    starts[square + 1] = (starts[square + 1] ?? 0) + 1;
  });
  for (let square = 1; square < starts.length; square += 1) {
    starts[square] = (starts[square] ?? 0) + (starts[square - 1] ?? 0);
  }
  return starts;
}

function membersOf(reaches: Uint16Array, nX: number, starts: Uint32Array): Uint32Array {
  const members = new Uint32Array(starts.at(-1) ?? 0);
  const next = starts.slice();
  eachSquare(reaches, nX, (square, triangle) => {
    const at = next[square] ?? 0;
    members[at] = triangle;
    next[square] = at + 1;
  });
  return members;
}

function eachSquare(
  reaches: Uint16Array,
  nX: number,
  tell: (square: number, triangle: number) => void,
): void {
  for (let i = 0; i < reaches.length; i += 4) {
    for (let row = reaches[i + 2] ?? 0; row <= (reaches[i + 3] ?? 0); row += 1) {
      for (let column = reaches[i] ?? 0; column <= (reaches[i + 1] ?? 0); column += 1) {
        tell(row * nX + column, i / 4);
      }
    }
  }
}

/** Lowest and highest of every third number. */
function range(corners: Float32Array, axis: number): [number, number] {
  let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (let i = axis; i < corners.length; i += 3) {
    low = Math.min(low, corners[i] ?? 0);
    high = Math.max(high, corners[i] ?? 0);
  }
  return low <= high ? [low, high] : [0, 0];
}

function sorted(one: number, other: number): [number, number] {
  return one < other ? [one, other] : [other, one];
}

/** Möller and Trumbore's: metres to a triangle, Infinity beside it. */
function hit(corners: Float32Array, at: number, from: Xyz, direction: Xyz): number {
  const corner = (index: number): [number, number, number] => [
    corners[at + 3 * index] ?? 0,
    corners[at + 3 * index + 1] ?? 0,
    corners[at + 3 * index + 2] ?? 0,
  ];
  const first = corner(0);
  const [one, other] = [minus(corner(1), first), minus(corner(2), first)];
  const across = cross(direction, other);
  const volume = dot(one, across);
  if (volume === 0) return Number.POSITIVE_INFINITY;
  const way = minus(from, first);
  const u = dot(way, across) / volume;
  const up = cross(way, one);
  const v = dot(direction, up) / volume;
  const distance = dot(other, up) / volume;
  return u >= 0 && v >= 0 && u + v <= 1 && distance >= 0 ? distance : Number.POSITIVE_INFINITY;
}

function minus(a: Xyz, b: Xyz): [number, number, number] {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function cross(a: Xyz, b: Xyz): [number, number, number] {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function dot(a: Xyz, b: Xyz): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
