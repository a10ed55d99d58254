/** Numbers about what is drawn, for the panel. */
import { type Field, type Lighting, viewsOfLighting } from "@irradia/runtime";
import type { LightSource } from "@irradia/three/webgpu";
import type { Model } from "../scene/model.js";
import type { BackendName } from "./renderer.js";

export interface Statistic {
  readonly label: string;
  readonly value: string;
  readonly hint?: string;
}

export interface FrameTimes {
  /** By the GPU's own clock; undefined where it has none to read. */
  readonly gpuMs: number | undefined;
  readonly cpuMs: number;
}

/** What is known of a frame with this source on the left. */
export function statisticsOf(
  model: Model,
  source: LightSource | undefined,
  times: FrameTimes,
  backend: BackendName,
  size: readonly [number, number],
): Statistic[] {
  const shader = source?.shader;
  const field = model.fields.get(source?.name ?? "");
  const wire = source && wireBytes(model, source);
  const hint =
    times.gpuMs === undefined
      ? "By the CPU's clock: this browser has no timestamp queries."
      : "By timestamp query.";
  return [
    { label: "Backend", value: backend === "webgpu" ? "WebGPU" : "WebGL 2" },
    { label: "Picture", value: `${size[0]} × ${size[1]}` },
    {
      label: times.gpuMs === undefined ? "Frame, CPU" : "Frame, GPU",
      value: `${(times.gpuMs ?? times.cpuMs).toFixed(1)} ms`,
      hint,
    },
    { label: "Triangles", value: model.nTriangles.toLocaleString("en") },
    { label: "File", value: bytesText(model.bytes.file), hint: "All of the scene as it came." },
    ...(wire
      ? [{ label: "Light on the wire", value: bytesText(wire), hint: "What of it this source is." }]
      : []),
    ...(shader
      ? [
          { label: "Light on GPU", value: bytesText(shader.cost.bytes) },
          { label: "Work", value: `${shader.cost.flops.toLocaleString("en")} FLOP/px` },
          { label: "Fetches", value: `${shader.cost.fetches.toLocaleString("en")} /px` },
        ]
      : []),
    ...(field ? [{ label: "Parameters", value: parametersOf(field).toLocaleString("en") }] : []),
  ];
}

/** `1.2 MB`, in thousands. */
export function bytesText(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  const [value, unit] = bytes < 1e6 ? [bytes / 1e3, "kB"] : [bytes / 1e6, "MB"];
  return `${value.toFixed(value < 10 ? 1 : 0)} ${unit}`;
}

/** Bytes of a source as they came; 0 for none. */
function wireBytes(model: Model, { name, kind }: LightSource): number {
  const ofFile = model.fieldBytes.get(name);
  const lighting = model.light.baked?.lighting;
  if (ofFile !== undefined || !lighting) return ofFile ?? 0;
  const { lightmap, directional, field, probes } = lighting;
  const parts: Readonly<Record<LightSource["kind"], Lighting>> = {
    lightmap: { ...(lightmap && { lightmap }) },
    directional: { ...(directional && { directional }) },
    field: { ...(field && { field }) },
    probes: { ...(probes && { probes }) },
    "three-probes": { ...(probes && { probes }) },
    none: {},
  };
  return viewsOfLighting(parts[kind]).reduce((sum, view) => sum + (model.bytes.views[view] ?? 0), 0);
}

function parametersOf({ tensors }: Field): number {
  let total = 0;
  for (const { shape } of tensors.values()) total += shape.reduce((n, side) => n * side, 1);
  return total;
}
