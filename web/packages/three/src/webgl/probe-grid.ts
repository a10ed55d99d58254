/** three.js' own light probes, for WebGLRenderer. */
import type { Probes } from "@irradia/runtime";
import { LightProbeGridWebGL } from "three/addons/lighting/LightProbeGridWebGL.js";
import { GridLight } from "../core/painter.js";
import { probeAtlas } from "../core/probe-atlas.js";

export function probeGrid(probes: Probes): GridLight {
  const { size, centre, shape, texture } = probeAtlas(probes);
  const grid = new LightProbeGridWebGL(size.x, size.y, size.z, ...shape);
  grid.position.copy(centre);
  grid.updateBoundingBox();
  grid.texture = texture;
  return new GridLight(grid, texture);
}
