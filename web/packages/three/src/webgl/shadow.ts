/** Baked shadows of live lights in WebGLRenderer, whose shaders know lights by their place in a list. */
import { type Camera, type IUniform, type Light, type Object3D, ShaderChunk } from "three";
import type { ShadowMask } from "../core/shadow-mask.js";

interface Kind {
  readonly flag: "isPointLight" | "isSpotLight" | "isDirectionalLight";
  /** Of the uniform with a channel for each light, −1 for none. */
  readonly name: string;
  readonly count: string;
  /** What three.js calls for each light of the kind. */
  readonly call: string;
}

const KINDS: readonly Kind[] = [
  {
    flag: "isPointLight",
    name: "irradiaPointChannels",
    count: "NUM_POINT_LIGHTS",
    call: "getPointLightInfo( pointLight, geometryPosition, directLight );",
  },
  {
    flag: "isSpotLight",
    name: "irradiaSpotChannels",
    count: "NUM_SPOT_LIGHTS",
    call: "getSpotLightInfo( spotLight, geometryPosition, directLight );",
  },
  {
    flag: "isDirectionalLight",
    name: "irradiaSunChannels",
    count: "NUM_DIR_LIGHTS",
    call: "getDirectionalLightInfo( directionalLight, directLight );",
  },
];

export const MASK_DECLARATIONS = [
  "uniform mediump sampler2DArray irradiaMask;",
  ...KINDS.map(({ name, count }) => `#if ${count} > 0\nuniform int ${name}[${count}];\n#endif`),
  `float irradiaShare(int channel) {
  vec4 mask = texture(irradiaMask, vec3(vIrradiaUv, vIrradiaPage));
  return channel < 0 ? 1.0 : mask[channel];
}`,
].join("\n");

/** three.js' chunk in which direct light is added up, each light times its share. */
export function maskedLights(): string {
  return KINDS.reduce((chunk, { call, name }) => {
    return chunk.replace(call, () => `${call}\ndirectLight.color *= irradiaShare(${name}[ i ]);`);
  }, ShaderChunk.lights_fragment_begin);
}

/** Channels of the lights that shine in a scene, in the order of WebGLRenderer's lists. */
export class MaskChannels {
  readonly uniforms: Readonly<Record<string, IUniform>>;
  readonly #mask: ShadowMask;
  #frame = -1;

  constructor(mask: ShadowMask) {
    this.#mask = mask;
    const lists = KINDS.map(({ name }) => [name, { value: [] }]);
    this.uniforms = { irradiaMask: { value: mask.texture }, ...Object.fromEntries(lists) };
  }

  /** To be called before a mesh is drawn; looks around once a frame. */
  update(scene: Object3D, camera: Camera, frame: number): void {
    if (frame === this.#frame) return;
    this.#frame = frame;
    const lights = shiningLights(scene, camera);
    for (const { flag, name } of KINDS) {
      const ofKind = lights.filter((light) => flag in light);
      const uniform = this.uniforms[name];
      if (uniform) uniform.value = ofKind.map((light) => this.#mask.channels.get(light) ?? -1);
    }
  }
}

/** As the renderer collects and sorts them: as they stand in the scene, those that cast shadows or a map first. */
function shiningLights(scene: Object3D, camera: Camera): Light[] {
  const lights: Light[] = [];
  const visit = (object: Object3D): void => {
    if (!object.visible) return;
    if ("isLight" in object && object.layers.test(camera.layers)) lights.push(object as Light);
    for (const child of object.children) visit(child);
  };
  visit(scene);
  return lights.sort((a, b) => rank(b) - rank(a));
}

function rank(light: Light & { map?: unknown }): number {
  return (light.castShadow ? 2 : 0) + (light.map ? 1 : 0);
}
