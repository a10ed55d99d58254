/** Irradia's baked light in the browser: readers with strict checks, a readable evaluator, GPU textures. */
export { expect, InputError } from "./errors.js";
export type { Encoding, TensorSlot, Vec3 } from "./field/encoding.js";
export { Composite } from "./field/encodings/composite.js";
export { Frequency } from "./field/encodings/frequency.js";
export { HashGrid, type HashGridOptions, type HashLevel } from "./field/encodings/hash-grid.js";
export { Identity } from "./field/encodings/identity.js";
export { OneBlob } from "./field/encodings/one-blob.js";
export { ENCODING_TYPES } from "./field/encodings/registry.js";
export { SphericalHarmonics } from "./field/encodings/spherical-harmonics.js";
export { TriPlane } from "./field/encodings/tri-plane.js";
export { type Field, FieldEvaluator, tensorOf } from "./field/field.js";
export { irradianceOf, irradianceWeights } from "./field/sh.js";
export {
  type Activation,
  type FieldFrame,
  type FieldSpec,
  type Head,
  type LayerShape,
  layerShapes,
  type Mode,
  N_OUTPUTS,
  nFeatures,
  type Quantity,
  tensorShapes,
  toUnit,
} from "./field/spec.js";
export {
  bitsPerValue,
  type Codes,
  type Floats,
  type Halves,
  storedBytes,
  type Tensor,
  tensorValues,
} from "./field/tensor.js";
export { readFieldBin } from "./formats/field-bin.js";
export { type ReadFieldOptions, readField } from "./formats/field-safetensors.js";
export { type LightTexture, readKtx2, type TexelEncoding, texelRgb } from "./formats/ktx2.js";
export type { UnpackOptions, Unzstd } from "./formats/zstd.js";
export { type ConstantsPlan, type LayerPlacement, PADDED_WIDTHS, type Precision } from "./gpu/constants.js";
export {
  type EntryLayout,
  type FieldTextures,
  planFieldTextures,
  type TableBits,
  type TablePlacement,
  type TableTexture,
} from "./gpu/field-textures.js";
export { planLightTexture } from "./gpu/light-textures.js";
export { entryPlace, type PackedField, packField, texelStride, wordsPerTexel } from "./gpu/pack.js";
export {
  type TextureFormat,
  type TextureLimits,
  type TexturePlan,
  WEBGL2_LIMITS,
  WEBGPU_LIMITS,
} from "./gpu/texture.js";
export {
  type BakedLight,
  type ReadBakedOptions,
  readBaked,
  readBakedGlb,
  readFieldOf,
  readMap,
} from "./scene/baked.js";
export { type BufferViews, type GltfFile, gltfFile, readGlb } from "./scene/glb.js";
export {
  DIRECTIONAL_MAPS,
  type DirectionalEntry,
  type DirectionalMode,
  EXTENSION,
  type FieldEntry,
  type Lighting,
  type LightmapEntry,
  type MapEntry,
  readLighting,
  viewsOfLighting,
} from "./scene/lighting.js";
export {
  type NodeLight,
  type PrimitiveLight,
  type Rectangle,
  readNodeLight,
  viewsOfNodes,
} from "./scene/nodes.js";
export {
  NO_PROBE,
  type ProbeGrid,
  type ProbeOctree,
  type Probes,
  probeCoefficients,
  readProbes,
} from "./scene/probes.js";
export {
  composeText,
  type PieceChoices,
  type PieceLanguage,
  type PiecePick,
  type ShaderPart,
  type ShaderPiece,
} from "./shaders/compose.js";
export { directionalShader } from "./shaders/directional-shader.js";
export { type FieldShaderOptions, fieldShader } from "./shaders/field-shader.js";
export type {
  LightInput,
  LightShader,
  LightView,
  ShaderCost,
  ShaderFeature,
  ShaderLanguage,
  ShaderTexture,
  ShaderUniforms,
} from "./shaders/light-shader.js";
export { directives } from "./shaders/light-shader.js";
export { lightmapShader } from "./shaders/lightmap-shader.js";
export { PIECES } from "./shaders/pieces.js";
export { type ProbeShaderOptions, probeShader } from "./shaders/probe-shader.js";
export {
  halfSize,
  isForScreens,
  prepassText,
  type ScreenStage,
  type ScreenView,
  screenCall,
  screenConstants,
  screenText,
} from "./shaders/screen.js";
export { withDirect } from "./shaders/with-direct.js";
