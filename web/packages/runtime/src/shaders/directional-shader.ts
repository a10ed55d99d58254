/** Directional lightmaps as sources of light: they answer to normal maps. docs/directional.md */
import { expect } from "../errors.js";
import type { LightTexture } from "../formats/ktx2.js";
import type { TextureLimits } from "../gpu/texture.js";
import type { BakedLight } from "../scene/baked.js";
import type { DirectionalMode } from "../scene/lighting.js";
import { composeText } from "./compose.js";
import type { LightInput, LightShader } from "./light-shader.js";
import { bytesOf, mapTexture } from "./map-texture.js";

/** How a mode is read: which maps under which names, which of them hold light, and what that takes. */
interface Reading {
  /** By name in the shader the map's name in the file; `plain` is the lightmap itself. */
  readonly maps: Readonly<Record<string, string>>;
  readonly nLightMaps: number;
  readonly needsTangent: boolean;
  readonly flops: number;
}

const READINGS: Readonly<Record<DirectionalMode, Reading>> = {
  dominant: {
    maps: { irradia_lightmap: "plain", irradia_direction: "direction" },
    nLightMaps: 1,
    needsTangent: false,
    flops: 35,
  },
  rnm: {
    maps: { irradia_rnm_a: "rnm_0", irradia_rnm_b: "rnm_1", irradia_rnm_c: "rnm_2" },
    nLightMaps: 3,
    needsTangent: true,
    flops: 62,
  },
  sh: {
    maps: { irradia_sh_mean: "sh_l0", irradia_sh_x: "sh_x", irradia_sh_y: "sh_y", irradia_sh_z: "sh_z" },
    nLightMaps: 1,
    needsTangent: false,
    flops: 104,
  },
  "mono-sh": {
    maps: { irradia_sh_mean: "sh_l0", irradia_sh_direction: "sh_direction" },
    nLightMaps: 1,
    needsTangent: false,
    flops: 46,
  },
};

/**
 * The directional maps of a baked scene.
 *
 * @throws InputError where it has none, or its pages are too large for the device
 */
export function directionalShader(baked: BakedLight, limits: TextureLimits): LightShader {
  const entry = baked.lighting.directional;
  expect(entry !== undefined, "expected directional maps", "scene", "Bake with --directional sh.");
  const { maps, nLightMaps, needsTangent, flops } = READINGS[entry.mode];
  const found = Object.entries(maps).map(([name, map]) => ({ name, ...mapOf(baked, map) }));
  const textures = found.map(({ name, texture }) => mapTexture(name, texture, limits));
  const scales = found.map(({ scale }, i) => (i < nLightMaps ? Math.PI * scale : scale));
  const tangent: LightInput[] = needsTangent ? ["tangent"] : [];
  return {
    entry: "irradia_light",
    inputs: ["normal", "surfaceNormal", ...tangent, "lightmapUv", "page"],
    textures,
    uniforms: [
      { name: "irradia_map_scales", values: Float32Array.from({ length: 4 }, (_, i) => scales[i] ?? 0) },
    ],
    quantity: baked.lighting.lightmap?.light ?? "full",
    cost: { flops, fetches: textures.length, bytes: bytesOf(textures, 1) },
    views: {},
    text: (language) => composeText(language, [`directional-${entry.mode}-light`]),
  };
}

/** A map by its name in the file. */
function mapOf(baked: BakedLight, name: string): { texture: LightTexture; scale: number } {
  const { lighting, lightmap, directional } = baked;
  const entry = name === "plain" ? lighting.lightmap : lighting.directional?.maps.get(name);
  const texture = name === "plain" ? lightmap : directional?.get(name);
  expect(entry !== undefined && texture !== undefined, `the map '${name}' is missing`, "scene");
  return { texture, scale: entry.scale };
}
