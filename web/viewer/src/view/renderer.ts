/** three.js' renderer on WebGPU or WebGL2, chosen by us: left to itself it falls back with a warning. */
import { InputError } from "@irradia/runtime";
import { LinearSRGBColorSpace, NoToneMapping, WebGPURenderer } from "three/webgpu";
import type { Backend } from "../state/state.js";

/** What draws, for people and for `data-backend`. */
export type BackendName = "webgpu" | "webgl2";

/**
 * @param canvas a new one: its context can be of one kind only
 * @throws InputError where the browser has neither, or not the one that is asked for
 */
export async function makeRenderer(canvas: HTMLCanvasElement, wanted: Backend): Promise<WebGPURenderer> {
  const forceWebGL = wanted === "webgl2" || !(await hasWebGPU());
  if (wanted === "webgpu" && forceWebGL) {
    throw new InputError(
      "expected WebGPU, found none",
      "browser",
      "Leave renderer=webgpu out of the address.",
    );
  }
  if (forceWebGL && !document.createElement("canvas").getContext("webgl2")) {
    const fix = "Switch hardware acceleration on in its settings, or try another browser.";
    throw new InputError("expected WebGPU or WebGL2, found neither", "browser", fix);
  }
  const renderer = new WebGPURenderer({ canvas, forceWebGL, trackTimestamp: hasTimestamps(forceWebGL) });
  await renderer.init();
  renderer.toneMapping = NoToneMapping;
  renderer.outputColorSpace = LinearSRGBColorSpace;
  renderer.setClearColor(0x000000, 0);
  return renderer;
}

export function backendOf(renderer: WebGPURenderer): BackendName {
  return "isWebGPUBackend" in renderer.backend ? "webgpu" : "webgl2";
}

async function hasWebGPU(): Promise<boolean> {
  const gpu = (navigator as { gpu?: { requestAdapter(): Promise<unknown> } }).gpu;
  try {
    return gpu !== undefined && (await gpu.requestAdapter()) !== null;
  } catch {
    return false;
  }
}

/** WebGL's extension must be looked for first: three.js warns about its absence. */
function hasTimestamps(forceWebGL: boolean): boolean {
  if (!forceWebGL) return true;
  const gl = document.createElement("canvas").getContext("webgl2");
  return gl?.getExtension("EXT_disjoint_timer_query_webgl2") != null;
}
