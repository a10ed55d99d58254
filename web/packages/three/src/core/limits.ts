/** What devices take, where nobody asked the renderer. */
import { type TextureLimits, WEBGL2_LIMITS } from "@irradia/runtime";

/**
 * What nearly every device of these years takes. Uniforms are kept few: WebGLRenderer has them in the default
 * block, beside its own.
 */
export const COMMON_LIMITS: TextureLimits = { maxSize: 8192, maxLayers: 256, maxUniformBytes: 4096 };

/** The same where uniforms have a block of their own. */
export const COMMON_BLOCK_LIMITS: TextureLimits = {
  ...COMMON_LIMITS,
  maxUniformBytes: WEBGL2_LIMITS.maxUniformBytes,
};
