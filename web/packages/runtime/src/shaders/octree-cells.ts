/** An octree of probes as a list of words that a shader walks down; `shaders/wgsl/probe-cell-octree.wgsl`. */
import { expect } from "../errors.js";
import type { ProbeOctree } from "../scene/probes.js";

const LEAF = 2 ** 30;
const NOTHING = 2 ** 31;
const UNFILLED = 2 ** 32 - 1;
/** Ten bits an axis say which root is nearest. */
const MAX_ROOTS_A_SIDE = 1024;
const MAX_ROOTS = 2 ** 20;
/** Shaders have the place of the first corner as a float. */
const MAX_NODES = 2 ** 24;
/** What to add to a child's number, by bits, from its nearest siblings to the one opposite. */
const SIBLINGS = [1, 2, 4, 3, 5, 6, 7] as const;

export interface OctreeCells {
  readonly words: Uint32Array;
  /** Roots along each axis. */
  readonly shape: readonly [number, number, number];
  /** The word at which corners begin, eight a leaf. */
  readonly firstCorner: number;
}

/**
 * Builds the tree over an octree's leaves.
 *
 * @throws InputError where leaves overlap, or lie too far apart
 */
export function octreeCells(tree: ProbeOctree): OctreeCells {
  const shape = rootsShape(tree);
  const nodes = new Array<number>(shape[0] * shape[1] * shape[2]).fill(UNFILLED);
  const nRoots = nodes.length;
  for (let leaf = 0; leaf < tree.count; leaf++) insertLeaf(nodes, tree, leaf, shape);
  pointToRoots(nodes, shape);
  for (let first = nRoots; first < nodes.length; first += 8) pointToSiblings(nodes, first);
  const words = new Uint32Array(nodes.length + tree.corners.length);
  words.set(nodes);
  words.set(tree.corners, nodes.length);
  return { words, shape, firstCorner: nodes.length };
}

/** x, y, z and level of a leaf. */
function cellOf({ cells }: ProbeOctree, leaf: number): [number, number, number, number] {
  const [x = 0, y = 0, z = 0, level = 0] = cells.subarray(4 * leaf, 4 * leaf + 4);
  return [x, y, z, level];
}

function rootsShape(tree: ProbeOctree): [number, number, number] {
  const shape: [number, number, number] = [1, 1, 1];
  for (let leaf = 0; leaf < tree.count; leaf++) {
    const [x, y, z, level] = cellOf(tree, leaf);
    shape[0] = Math.max(shape[0], (x >> level) + 1);
    shape[1] = Math.max(shape[1], (y >> level) + 1);
    shape[2] = Math.max(shape[2], (z >> level) + 1);
  }
  const fits = Math.max(...shape) <= MAX_ROOTS_A_SIDE && shape[0] * shape[1] * shape[2] <= MAX_ROOTS;
  const finding = `expected at most ${MAX_ROOTS} cells of level 0, found ${shape.join(" × ")}`;
  expect(fits, finding, "probes", "Bake probes with another placement, such as --probes grid:0.5.");
  return shape;
}

function insertLeaf(nodes: number[], tree: ProbeOctree, leaf: number, [nx, ny]: readonly number[]): void {
  const [x, y, z, level] = cellOf(tree, leaf);
  let at = (x >> level) + (nx ?? 1) * ((y >> level) + (ny ?? 1) * (z >> level));
  for (let below = level - 1; below >= 0; below--) {
    const child = ((x >> below) & 1) + 2 * ((y >> below) & 1) + 4 * ((z >> below) & 1);
    at = childrenOf(nodes, at, leaf) + child;
  }
  expect(nodes[at] === UNFILLED, `leaf ${leaf} overlaps another`, "probes");
  nodes[at] = LEAF + leaf;
}

/** The first child of a node, which is made an inner one where it wasn't. */
function childrenOf(nodes: number[], at: number, leaf: number): number {
  const word = nodes[at] ?? UNFILLED;
  if (word < LEAF) return word;
  expect(word === UNFILLED, `leaf ${leaf} overlaps another`, "probes");
  expect(nodes.length + 8 < MAX_NODES, `expected at most ${MAX_NODES} cells`, "probes");
  const first = nodes.length;
  nodes[at] = first;
  nodes.push(...new Array<number>(8).fill(UNFILLED));
  return first;
}

/** Makes empty children say which of their siblings to take instead. */
function pointToSiblings(nodes: number[], first: number): void {
  const children = nodes.slice(first, first + 8);
  children.forEach((word, child) => {
    if (word !== UNFILLED) return;
    const step = SIBLINGS.find((bits) => children[child ^ bits] !== UNFILLED) ?? 0;
    nodes[first + child] = NOTHING + (child ^ step);
  });
}

/** Makes empty roots say which root to take instead: the nearest by steps along the axes. */
function pointToRoots(nodes: number[], shape: readonly [number, number, number]): void {
  const [nx, ny] = shape;
  const strides = [1, nx, nx * ny];
  const nRoots = nx * ny * shape[2];
  const placeOf = (at: number): number[] => [at % nx, Math.floor(at / nx) % ny, Math.floor(at / (nx * ny))];
  const queue = Array.from({ length: nRoots }, (_, at) => at).filter((at) => nodes[at] !== UNFILLED);
  for (let i = 0; i < queue.length; i++) {
    const at = queue[i] ?? 0;
    const place = placeOf(at);
    const nearest = (nodes[at] ?? 0) >= NOTHING ? (nodes[at] ?? 0) : NOTHING + packed(place);
    strides.forEach((stride, axis) => {
      for (const step of [-1, 1]) {
        const along = (place[axis] ?? 0) + step;
        const neighbour = at + step * stride;
        if (along < 0 || along >= (shape[axis] ?? 1) || nodes[neighbour] !== UNFILLED) continue;
        nodes[neighbour] = nearest;
        queue.push(neighbour);
      }
    });
  }
}

function packed([x = 0, y = 0, z = 0]: number[]): number {
  return x + 1024 * (y + 1024 * z);
}
