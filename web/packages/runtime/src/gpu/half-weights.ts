/** The matrices of a perceptron in half precision; `shaders/wgsl/perceptron-half.wgsl` reads them. */
import { expect } from "../errors.js";
import { type Field, tensorOf } from "../field/field.js";
import { tensorValues } from "../field/tensor.js";
import { halfFromNumber, LARGEST_HALF } from "../numbers.js";
import type { ConstantsPlan, LayerPlacement } from "./constants.js";

/**
 * Matrices one behind another in blocks of 4 × 4. A column of a block is four halves, and a texel has two columns,
 * the first in its first two words. Blocks of the first matrix go by columns, so that a texel is the column of one
 * feature in two blocks, one below the other; blocks of others go by rows.
 *
 * @throws InputError where a weight is beyond what halves hold
 */
export function packHalfWeights(field: Field, { layers, weights }: ConstantsPlan): Uint32Array {
  const words = new Uint32Array((weights?.nBytes ?? 0) / 4);
  const halves = new Uint16Array(words.buffer);
  layers.forEach((layer, i) => {
    const name = `mlp.${i}.weight`;
    const values = tensorValues(tensorOf(field, name));
    expectHalves(values, name);
    for (let row = 0; row < layer.nOutputs; row++) {
      for (let column = 0; column < layer.nInputs; column++) {
        const four = 2 * layer.firstWeight + columnOf(layer, i === 0, row >> 2, column);
        halves[4 * four + (row & 3)] = halfFromNumber(values[row * layer.nInputs + column] ?? 0);
      }
    }
  });
  return words;
}

/** Where four rows of a column are in their matrix, counted by fours. */
function columnOf(
  { blocksIn, blocksOut }: LayerPlacement,
  isFirst: boolean,
  block: number,
  column: number,
): number {
  if (isFirst) return column * blocksOut + block;
  return 4 * (block * blocksIn + (column >> 2)) + (column & 3);
}

function expectHalves(values: Float32Array, name: string): void {
  const largest = values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  expect(
    largest <= LARGEST_HALF,
    `expected weights of at most ${LARGEST_HALF}, which is what half floats hold, found ${largest}`,
    name,
    'Take precision "float".',
  );
}
