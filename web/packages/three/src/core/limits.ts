/** What devices take, where nobody asked the renderer. */
import type { TextureLimits } from "@irradia/runtime";

/**
 * What nearly every device of these years takes. Uniforms are kept few: WebGLRenderer has them in the default
 * block, beside its own.
 */
export const COMMON_LIMITS: TextureLimits = { maxSize: 8192, maxLayers: 256, maxUniformBytes: 4096 };
