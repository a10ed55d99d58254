import type { Encoding, TensorSlot, Vec3 } from "../encoding.js";

/** Several encodings of the same point in [0, 1]³; features and parameters one after another. */
export class Composite implements Encoding {
  static readonly type = "composite";
  readonly type = Composite.type;
  readonly domain = "cube";
  readonly parts: readonly Encoding[];
  readonly nOutputs: number;
  readonly slots: readonly TensorSlot[];

  constructor(parts: readonly Encoding[]) {
    this.parts = parts;
    this.nOutputs = parts.reduce((sum, part) => sum + part.nOutputs, 0);
    this.slots = parts.flatMap((part, index) =>
      part.slots.map(({ name, shape }) => ({ name: `${index}.${name}`, shape })),
    );
  }

  forward(x: Vec3, tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    let [tensor, feature] = [0, first];
    for (const part of this.parts) {
      part.forward(x, tensors.slice(tensor, tensor + part.slots.length), out, feature);
      tensor += part.slots.length;
      feature += part.nOutputs;
    }
  }
}
