/** A source, a mesh and a renderer's part that do nothing but count. */
import type { LightShader } from "@irradia/runtime";
import { BufferGeometry, type EventDispatcher, Mesh, MeshStandardMaterial } from "three";
import type { Painter } from "../src/core/painter.js";

/** A shader that nobody compiles, of one texel. */
export function madeShader(): LightShader {
  const plan = { width: 1, height: 1, layers: 1, format: "r32uint", nBytes: 4 } as const;
  return {
    entry: "irradia_light",
    inputs: ["position", "normal"],
    textures: [{ name: "irradia_table", plan, data: new Uint32Array(1), access: "load" }],
    uniforms: [],
    quantity: "full",
    cost: { flops: 0, fetches: 0, bytes: 0 },
    views: {},
    text: () => "",
  };
}

/** Paints nothing. */
export function madePainter(): Painter {
  return {
    limits: { maxSize: 8192, maxLayers: 256, maxUniformBytes: 4096 },
    intensity: 1,
    paint: () => {},
    screenChanged: () => {},
    shadow: () => () => {},
    probeGrid: () => {
      throw new Error("there are no probes");
    },
  };
}

/** A mesh that counts what it is dressed in. */
export class CountedMesh extends Mesh {
  nDressed = 0;

  constructor() {
    super(new BufferGeometry());
    let worn: Mesh["material"] = new MeshStandardMaterial();
    Object.defineProperty(this, "material", {
      get: () => worn,
      set: (material: Mesh["material"]) => {
        worn = material;
        this.nDressed += 1;
      },
    });
  }
}

/** Counts how often something is disposed of. */
export function disposals(of: unknown): () => number {
  let n = 0;
  (of as EventDispatcher<{ dispose: object }>).addEventListener("dispose", () => {
    n += 1;
  });
  return () => n;
}
