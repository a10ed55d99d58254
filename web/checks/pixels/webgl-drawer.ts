/** WebGLRenderer, whose materials show channels by a patch at the end of their shaders. */
import { IrradiancePass, irradia, limitsOf, type SceneLight } from "@irradia/three";
import {
  type Camera,
  FloatType,
  type Material,
  Mesh,
  NearestFilter,
  NoToneMapping,
  type Scene,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { CHANNELS, type Drawer, flipped, type ScreenPass, showFrame } from "./drawer.js";
import type { Channel, Picture } from "./request.js";

const VARYINGS = `
  varying vec3 check_position;
  varying vec4 check_uv;
`;
const VERTEX = `
  vec4 check_world = vec4(transformed, 1.0);
  check_uv = vec4(lightmapUv, objectNumber, 0.0);
  #ifdef USE_INSTANCING
    check_world = instanceMatrix * check_world;
    check_uv.w = float(gl_InstanceID);
  #endif
  check_position = (modelMatrix * check_world).xyz;
`;
const FRAGMENT = `
  if (check_channel == 2) gl_FragColor = vec4(check_position, 1.0);
  if (check_channel == 3) gl_FragColor = vec4(normal * mat3(viewMatrix), 1.0);
  if (check_channel == 4) gl_FragColor = vec4(nonPerturbedNormal * mat3(viewMatrix), 1.0);
  if (check_channel == 5) {
    #ifdef USE_NORMALMAP_TANGENTSPACE
      float check_turn = dot(cross(nonPerturbedNormal, tbn[0]), tbn[1]) < 0.0 ? -1.0 : 1.0;
      gl_FragColor = vec4(normalize(tbn[0]) * mat3(viewMatrix), check_turn);
    #else
      gl_FragColor = vec4(0.0);
    #endif
  }
  if (check_channel == 6) gl_FragColor = check_uv;
`;

export class WebglDrawer implements Drawer {
  readonly backend = "webgl";
  readonly renderer = new WebGLRenderer();
  readonly #target: WebGLRenderTarget;
  readonly #channel = { value: 0 };

  constructor(width: number, height: number) {
    const filters = { minFilter: NearestFilter, magFilter: NearestFilter };
    this.#target = new WebGLRenderTarget(width, height, { type: FloatType, ...filters });
    this.renderer.toneMapping = NoToneMapping;
    this.renderer.setClearColor(0x000000, 0);
  }

  get limits() {
    return limitsOf(this.renderer);
  }

  get plugin() {
    return irradia({ limits: this.limits });
  }

  newPass(light: SceneLight, how: Picture["how"]): ScreenPass | undefined {
    return how === "inline" ? undefined : new IrradiancePass(this.renderer, light, { resolution: how });
  }

  show(scene: Scene, camera: Camera, pass?: ScreenPass): void {
    showFrame(this.renderer, this.#target, scene, camera, pass);
  }

  /** Reading a pixel waits for it; `finish` of WebGL may not. */
  async finish(): Promise<void> {
    this.renderer.readRenderTargetPixels(this.#target, 0, 0, 1, 1, new Float32Array(4));
  }

  async draw(scene: Scene, camera: Camera, pass?: ScreenPass): Promise<Float32Array> {
    const { width, height } = this.#target;
    const rgba = new Float32Array(4 * width * height);
    this.show(scene, camera, pass);
    await this.renderer.readRenderTargetPixelsAsync(this.#target, 0, 0, width, height, rgba);
    const error = this.renderer.getContext().getError();
    if (error !== 0) throw new Error(`WebGL reported error ${error}`);
    return flipped(rgba, width, height);
  }

  showChannels(scene: Scene): (channel: Channel | undefined) => void {
    const materials = new Set<Material>();
    scene.traverse((object) => {
      if (object instanceof Mesh) materials.add(object.material);
    });
    for (const material of materials) this.#patch(material);
    return (channel) => {
      this.#channel.value = CHANNELS.indexOf(channel ?? "unlit");
    };
  }

  #patch(material: Material): void {
    material.onBeforeCompile = (shader) => {
      shader.uniforms.check_channel = this.#channel;
      const attributes = "attribute vec2 lightmapUv; attribute float objectNumber;";
      shader.vertexShader = `${attributes}${VARYINGS}${shader.vertexShader}`.replace(
        "#include <project_vertex>",
        `#include <project_vertex>${VERTEX}`,
      );
      shader.fragmentShader = `uniform int check_channel;${VARYINGS}${shader.fragmentShader}`.replace(
        "#include <dithering_fragment>",
        FRAGMENT,
      );
    };
  }
}
