import { SRGBColorSpace } from "three";
import type { GLTFLoaderPlugin, GLTFParser } from "three/addons/loaders/GLTFLoader.js";

/** Reads MOZ_lightmap: texel · intensity is E/π, and three.js wants E. */
export const mozLightmap = (parser: GLTFParser): GLTFLoaderPlugin => ({
  name: "MOZ_lightmap",
  extendMaterialParams: async (index, params) => {
    const lightmap = parser.json.materials[index].extensions?.MOZ_lightmap;
    if (!lightmap) return;
    params.lightMapIntensity = (lightmap.intensity ?? 1) * Math.PI;
    await parser.assignTexture(params, "lightMap", lightmap, SRGBColorSpace);
  },
});
