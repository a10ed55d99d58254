/** What a device behind WebGPURenderer takes. */
import type { Precision, TextureLimits } from "@irradia/runtime";
import type { Renderer } from "three/webgpu";

/** Limits of textures; the renderer must be initialised. */
export function limitsOf(renderer: Renderer): TextureLimits {
  const backend = renderer.backend as unknown as { device?: GPUDevice; gl?: WebGL2RenderingContext };
  if (backend.device) {
    const { maxTextureDimension2D, maxTextureArrayLayers, maxUniformBufferBindingSize } =
      backend.device.limits;
    return {
      maxSize: maxTextureDimension2D,
      maxLayers: maxTextureArrayLayers,
      maxUniformBytes: maxUniformBufferBindingSize,
    };
  }
  const { gl } = backend;
  if (!gl) throw new Error("limitsOf: await renderer.init() before");
  return {
    maxSize: gl.getParameter(gl.MAX_TEXTURE_SIZE),
    maxLayers: gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS),
    maxUniformBytes: gl.getParameter(gl.MAX_UNIFORM_BLOCK_SIZE),
  };
}

/**
 * The least precision of a field's perceptron that the device computes: `half` where it has `shader-f16`, as
 * `fieldShader(field, limitsOf(renderer), { precision: precisionOf(renderer) })` takes it. The renderer must be
 * initialised; WebGPURenderer on WebGL2 has no halves.
 */
export function precisionOf(renderer: Renderer): Precision {
  const { device } = renderer.backend as unknown as { device?: GPUDevice };
  return device?.features.has("shader-f16") ? "half" : "float";
}
