import { Identity } from "../../field/encodings/identity.js";
import type { EncodingShader } from "./encoding-shader.js";

export const identityShader: EncodingShader<Identity> = {
  type: Identity.type,
  piece: "identity",
  function: "irradia_identity",
  record: (_, { firstColumn }) => [[firstColumn, 0, 0, 0]],
  cost: () => ({ flops: 0, fetches: 0 }),
};
