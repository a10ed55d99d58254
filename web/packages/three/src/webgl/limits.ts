/** What a device behind WebGLRenderer takes. */
import type { TextureLimits } from "@irradia/runtime";
import type { WebGLRenderer } from "three";

/** Vectors of uniforms that three.js' largest materials and a dozen lights take. */
const RESERVED_VECTORS = 200;

/** Limits of textures. Uniforms stand in the default block, beside three.js' own. */
export function limitsOf({ capabilities, getContext }: WebGLRenderer): TextureLimits {
  const gl = getContext() as WebGL2RenderingContext;
  return {
    maxSize: capabilities.maxTextureSize,
    maxLayers: gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS),
    maxUniformBytes: 16 * Math.max(capabilities.maxFragmentUniforms - RESERVED_VECTORS, 0),
  };
}
