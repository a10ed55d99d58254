/** WebGPURenderer on either backend, whose materials show channels through the context's last word. */
import { IrradiancePass, irradia, limitsOf, type SceneLight } from "@irradia/three/webgpu";
import type { Camera, Scene } from "three";
import {
  attribute,
  bitangentView,
  cameraViewMatrix,
  cameraWorldMatrix,
  context,
  float,
  instanceIndex,
  negateOnBackSide,
  normalViewGeometry,
  normalWorld,
  positionWorld,
  renderGroup,
  select,
  tangentView,
  uniform,
  varying,
  vec4,
} from "three/tsl";
import {
  FloatType,
  NearestFilter,
  type Node,
  type NodeBuilder,
  NoToneMapping,
  RenderTarget,
  WebGPURenderer,
} from "three/webgpu";
import { CHANNELS, type Drawer, flipped, type ScreenPass, showFrame } from "./drawer.js";
import type { Backend, Channel, Picture } from "./request.js";

export class WebgpuDrawer implements Drawer {
  readonly renderer: WebGPURenderer;
  readonly #target: RenderTarget;
  readonly #channel = uniform(0, "int").setGroup(renderGroup);

  private constructor(renderer: WebGPURenderer, width: number, height: number) {
    const filters = { minFilter: NearestFilter, magFilter: NearestFilter };
    this.renderer = renderer;
    this.#target = new RenderTarget(width, height, { type: FloatType, ...filters });
  }

  static async create(backend: Backend, width: number, height: number): Promise<WebgpuDrawer> {
    const renderer = new WebGPURenderer({ forceWebGL: backend === "webgl2" });
    await renderer.init();
    renderer.toneMapping = NoToneMapping;
    renderer.setClearColor(0x000000, 0);
    return new WebgpuDrawer(renderer, width, height);
  }

  get backend(): Backend {
    return "isWebGPUBackend" in this.renderer.backend ? "webgpu" : "webgl2";
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

  async finish(): Promise<void> {
    this.renderer.initRenderTarget(this.#target);
    await this.renderer.readRenderTargetPixelsAsync(this.#target, 0, 0, 1, 1);
  }

  async draw(scene: Scene, camera: Camera, pass?: ScreenPass): Promise<Float32Array> {
    const { width, height } = this.#target;
    this.show(scene, camera, pass);
    const read = await this.renderer.readRenderTargetPixelsAsync(this.#target, 0, 0, width, height);
    if (!(read instanceof Float32Array)) throw new Error("expected a target of floats");
    return this.backend === "webgpu" ? read : flipped(read, width, height);
  }

  showChannels(): (channel: Channel | undefined) => void {
    const shown: Record<Channel, (picture: Node<"vec4">, builder: NodeBuilder) => Node<"vec4">> = {
      unlit: (picture) => picture,
      white: (picture) => picture,
      position: () => vec4(positionWorld, 1),
      normal: () => vec4(normalWorld, 1),
      surfaceNormal: () => vec4(facing().transformNormalByInverseViewMatrix(cameraViewMatrix), 1),
      tangent: (_, builder) => tangentOf(builder),
      lightmapUv: () => {
        const own = vec4(attribute("lightmapUv", "vec2"), attribute("objectNumber", "float"), 0);
        return varying(own.add(vec4(0, 0, 0, float(instanceIndex))));
      },
    };
    const getOutput = (picture: Node<"vec4">, builder: NodeBuilder) => {
      const pick = (rest: Node<"vec4">, channel: Channel, number: number) => {
        return select(this.#channel.equal(number), shown[channel](picture, builder), rest);
      };
      return CHANNELS.reduce(pick, picture);
    };
    this.renderer.contextNode = context({ getOutput });
    return (channel) => {
      if (channel) this.#channel.value = CHANNELS.indexOf(channel);
      else this.renderer.contextNode = context({});
    };
  }
}

/** The vertices' normal in view space, turned to the viewer. */
function facing(): Node<"vec3"> {
  return negateOnBackSide(normalViewGeometry);
}

/** In world space, w the bitangent's sign; 0 where no normal map asks for it. */
function tangentOf({ material }: NodeBuilder): Node<"vec4"> {
  if (!("normalMap" in material && material.normalMap)) return vec4(0);
  const bitangent = bitangentView as unknown as Node<"vec3">;
  const turn = facing().cross(tangentView).dot(bitangent);
  const along = tangentView.transformDirection(cameraWorldMatrix) as Node<"vec3">;
  return vec4(along, turn.sign() as Node<"float">);
}
