/** Encodings that shaders can evaluate. A new one is a piece in `shaders/wgsl/`, a file here, and a line here. */
import type { Encoding } from "../../field/encoding.js";
import type { EncodingShader } from "./encoding-shader.js";
import { frequencyShader } from "./frequency.js";
import { hashGridShader } from "./hash-grid.js";
import { identityShader } from "./identity.js";
import { oneBlobShader } from "./one-blob.js";
import { sphericalHarmonicsShader } from "./spherical-harmonics.js";
import { triPlaneShader } from "./tri-plane.js";

const SHADERS = [
  hashGridShader,
  triPlaneShader,
  frequencyShader,
  oneBlobShader,
  sphericalHarmonicsShader,
  identityShader,
] as const;

/** How shaders evaluate an encoding that isn't a composite. */
export function encodingShader(encoding: Encoding): EncodingShader<Encoding> {
  const found = SHADERS.find(({ type }) => type === encoding.type);
  if (!found) throw new Error(`shaders can't evaluate the encoding '${encoding.type}'`);
  return found as EncodingShader<Encoding>;
}
