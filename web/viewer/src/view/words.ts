/** What the page says about light, in sentences. */
import type { SceneLight } from "@irradia/three/webgpu";

/** Where first bounces of lights come from while this source is in use. */
export function directText(light: SceneLight, isStudio: boolean): string {
  if (isStudio) return "The file holds no light: the viewer's own shines.";
  const { source, directFrom } = light;
  if (source.kind === "none") {
    return directFrom === "lights" ? "Live lights alone." : "No light but what surfaces emit.";
  }
  if (directFrom === "source") return "Direct light is part of this source.";
  if (directFrom === "map") {
    return "Indirect light from this source, direct light from a baked map; on what moves from the lamps, without shadows.";
  }
  if (directFrom === "lights") return "Indirect light from this source, direct light from live lights.";
  return "Indirect light alone: there are no lights to give the direct part.";
}
