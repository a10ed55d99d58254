/** A field's encodings in the order of their features, composites in their parts. */
import type { Encoding } from "../field/encoding.js";
import { Composite } from "../field/encodings/composite.js";
import type { FieldSpec } from "../field/spec.js";

/** An encoding that isn't made of others. */
export interface EncodingLeaf {
  /** As its tensors are named in files: `position`, or `position.1` for the second part of a composite. */
  readonly owner: string;
  readonly input: "position" | "direction";
  /** Whether a direction comes as (n + 1) / 2; a composite wants that for all its parts. */
  readonly isCube: boolean;
  readonly encoding: Encoding;
  /** The perceptron's column of its first feature. */
  readonly firstColumn: number;
}

/** All of them. */
export function encodingLeaves({ position, direction }: FieldSpec): EncodingLeaf[] {
  const leaves: EncodingLeaf[] = [];
  let firstColumn = 0;
  const visit = (encoding: Encoding, leaf: Pick<EncodingLeaf, "owner" | "input" | "isCube">): void => {
    if (encoding instanceof Composite) {
      encoding.parts.forEach((part, i) => {
        visit(part, { ...leaf, owner: `${leaf.owner}.${i}` });
      });
      return;
    }
    leaves.push({ ...leaf, encoding, firstColumn });
    firstColumn += encoding.nOutputs;
  };
  visit(position, { owner: "position", input: "position", isCube: true });
  if (direction) {
    visit(direction, { owner: "direction", input: "direction", isCube: direction.domain === "cube" });
  }
  return leaves;
}
