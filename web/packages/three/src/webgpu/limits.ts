/** What a device behind WebGPURenderer takes. */
import type { TextureLimits } from "@irradia/runtime";
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
