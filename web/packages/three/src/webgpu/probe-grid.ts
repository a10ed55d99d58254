/** three.js' own light probes, for WebGPURenderer. */
import type { Probes } from "@irradia/runtime";
import { LightProbeGrid } from "three/addons/lighting/LightProbeGrid.js";
import { lightProbeGridIrradiance } from "three/addons/tsl/lighting/LightProbeGridNode.js";
import { normalWorld, positionWorld } from "three/tsl";
import type { Node } from "three/webgpu";
import { GridLight } from "../core/painter.js";
import { probeAtlas } from "../core/probe-atlas.js";

export function probeGrid(probes: Probes): GridLight {
  const { size, centre, shape, texture } = probeAtlas(probes);
  const grid = new LightProbeGrid(size.x, size.y, size.z, ...shape);
  grid.position.copy(centre);
  grid.updateBoundingBox();
  grid.texture = texture;
  return new GridLight(grid, texture);
}

/** What such a grid adds, for views. */
export function ownIrradiance({ grid }: GridLight): Node<"vec3"> {
  return lightProbeGridIrradiance(grid as LightProbeGrid, positionWorld, normalWorld);
}
