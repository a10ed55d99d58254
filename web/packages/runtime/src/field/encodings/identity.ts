import type { JsonView } from "../../json.js";
import type { Encoding, TensorSlot, Vec3 } from "../encoding.js";

/** The coordinates themselves; a normal comes as it is, in [−1, 1]. */
export class Identity implements Encoding {
  static readonly type = "identity";
  readonly type = Identity.type;
  readonly domain = "any";
  readonly nOutputs = 3;
  readonly slots: readonly TensorSlot[] = [];

  static read(spec: JsonView): Identity {
    spec.allow(["type"]);
    return new Identity();
  }

  forward(x: Vec3, _tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    out.set(x, first);
  }
}
