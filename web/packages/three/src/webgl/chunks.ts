/** GLSL around a source of light, in the terms of three.js' own chunks. */
import { CHECKER_TEXELS } from "../core/painter.js";
import { VALIDITY_COLOURS, VALIDITY_SHADE } from "../core/validity.js";
import { LIGHTMAP_ATTRIBUTES } from "../types.js";

const { uv, rectangle, page } = LIGHTMAP_ATTRIBUTES;
const { outside, hidden, whole } = VALIDITY_COLOURS;

export const VERTEX = {
  declarations: `
varying vec3 vIrradiaPosition;
varying float vIrradiaDepth;`,
  lightmapDeclarations: `
attribute vec2 ${uv};
attribute vec4 ${rectangle};
attribute float ${page};
varying vec2 vIrradiaUv;
flat varying float vIrradiaPage;`,
  /** The position in world space, from three.js' \`transformed\`; the depth, 0 to 1 from near to far. */
  position: `
{
  vec4 irradiaPosition = vec4(transformed, 1.0);
  #ifdef USE_BATCHING
  irradiaPosition = batchingMatrix * irradiaPosition;
  #endif
  #ifdef USE_INSTANCING
  irradiaPosition = instanceMatrix * irradiaPosition;
  #endif
  vIrradiaPosition = (modelMatrix * irradiaPosition).xyz;
  float a = projectionMatrix[2][2];
  float b = projectionMatrix[3][2];
  vec2 nearFar = isOrthographic ? vec2(b + 1.0, b - 1.0) / a : vec2(b / (a - 1.0), b / (a + 1.0));
  vIrradiaDepth = (-mvPosition.z - nearFar.x) / (nearFar.y - nearFar.x);
}`,
  place: `
vIrradiaUv = ${uv} * ${rectangle}.xy + ${rectangle}.zw;
vIrradiaPage = ${page};`,
};

export const FRAGMENT = {
  declarations: `
varying vec3 vIrradiaPosition;
varying float vIrradiaDepth;
uniform float irradiaIntensity;`,
  lightmapDeclarations: `
varying vec2 vIrradiaUv;
flat varying float vIrradiaPage;`,
  screenDeclarations: `uniform highp sampler2D irradiaScreen;`,
  screen: "texelFetch(irradiaScreen, ivec2(gl_FragCoord.xy), 0).rgb",
  /** What three.js has added up by itself. */
  own: "irradiance",
  /** Normals and tangent in world space; three.js turns its normal to the viewer where a material has two sides. */
  frame: `
vec3 irradiaNormal = normalize((vec4(normal, 0.0) * viewMatrix).xyz);
vec3 irradiaSurfaceNormal = normalize((vec4(nonPerturbedNormal, 0.0) * viewMatrix).xyz);
#ifdef STANDARD
vec3 irradiaAlbedo = material.diffuseContribution;
#else
vec3 irradiaAlbedo = diffuseColor.rgb;
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
vec3 irradiaAlong = normalize((vec4(tbn[0], 0.0) * viewMatrix).xyz);
vec4 irradiaTangent = vec4(irradiaAlong, dot(cross(nonPerturbedNormal, tbn[0]), tbn[1]) < 0.0 ? -1.0 : 1.0);
#else
vec3 irradiaAside = abs(irradiaSurfaceNormal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
vec4 irradiaTangent = vec4(normalize(cross(irradiaAside, irradiaSurfaceNormal)), 1.0);
#endif`,
  inputs: {
    position: "vIrradiaPosition",
    normal: "irradiaNormal",
    surfaceNormal: "irradiaSurfaceNormal",
    tangent: "irradiaTangent",
  },
  lightmapInputs: { lightmapUv: "vIrradiaUv", page: "vIrradiaPage" },
  /** Baked light holds the sky: its diffuse part goes, by the very formula that it came in by; its specular stays. */
  noSky: `
RE_IndirectDiffuse(-iblIrradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight);`,
  /** Behind ambient occlusion, since baked light holds that too. */
  add: `
RE_IndirectDiffuse(irradiaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight);`,
  views: {
    irradiance: "irradiaLight * RECIPROCAL_PI",
    albedo: "irradiaAlbedo",
    normal: "0.5 * irradiaNormal + 0.5",
    depth: "vec3(vIrradiaDepth)",
  } as Readonly<Record<string, string>>,
  checker: ([width, height]: readonly [number, number]) => {
    const field = `floor(vIrradiaUv * vec2(${width}.0, ${height}.0) / ${CHECKER_TEXELS}.0)`;
    return `vec3(vIrradiaUv, 0.5) * (mod(dot(${field}, vec2(1.0)), 2.0) < 0.5 ? 1.0 : 0.3)`;
  },
  validityDeclarations: `
uniform highp sampler2DArray irradiaValidity;
vec3 irradiaValidityColour(vec3 normal) {
  float code = 255.0 * texture(irradiaValidity, vec3(vIrradiaUv, vIrradiaPage)).r;
  vec3 inChart = mix(vec3(${hidden}), vec3(${whole}), (code - 1.0) / 254.0);
  vec3 colour = vIrradiaPage < 0.0 || code < 0.5 ? vec3(${outside}) : inChart;
  return colour * mix(1.0, 0.5 + 0.5 * normal.y, ${VALIDITY_SHADE});
}`,
  validity: "irradiaValidityColour(irradiaNormal)",
  missingView: "vec3(1.0, 0.0, 1.0)",
};
