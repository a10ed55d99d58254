/** Lamps in the materials of WebGPURenderer: three.js' own nodes, of one material alone. */
import type { DirectionalLight, Light, PointLight, SpotLight } from "three";
import {
  DirectionalLightNode,
  type Node,
  type NodeBuilder,
  PointLightNode,
  SpotLightNode,
} from "three/webgpu";
import type { Lamp, Lamps } from "../core/lamps.js";

/** What this module asks of a light's node; its types say less. */
interface LampNode {
  colorNode: Node<"vec3">;
  getHash(): string;
  setupShadow(builder: NodeBuilder): void;
  build(builder: NodeBuilder): void;
}

/** Adds their light to what is being built. */
export function shine({ list }: Lamps, intensity: Node<"float">, builder: NodeBuilder): void {
  for (const lamp of list) lampNode(lamp, intensity).build(builder);
}

function lampNode({ light, isTaken }: Lamp, intensity: Node<"float">): LampNode {
  const node = newNode(light) as unknown as LampNode;
  node.colorNode = isTaken ? node.colorNode.negate() : node.colorNode.mul(intensity);
  // Beside three.js' node of the same light, and without its shadows.
  node.getHash = () => `irradia-lamp-${light.uuid}`;
  node.setupShadow = () => {};
  return node;
}

function newNode(light: Light): object {
  if ("isPointLight" in light) return new PointLightNode(light as PointLight);
  if ("isSpotLight" in light) return new SpotLightNode(light as SpotLight);
  return new DirectionalLightNode(light as DirectionalLight);
}
