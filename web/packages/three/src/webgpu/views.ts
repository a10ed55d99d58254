/** Debug views that need no source of light. */
import {
  cameraFar,
  cameraNear,
  diffuseColor,
  diffuseContribution,
  normalWorld,
  positionView,
  vec3,
} from "three/tsl";
import type { Node, NodeBuilder } from "three/webgpu";
import { CHECKER_TEXELS } from "../core/painter.js";
import type { View } from "../types.js";
import { lightmapPlace } from "./inputs.js";

/** For views that a source lacks. */
export const MISSING_VIEW: Node<"vec3"> = /*@__PURE__*/ vec3(1, 0, 1);

/** The node of a view; undefined for those that are a source's affair. */
export function commonView(
  view: View | null,
  { material }: NodeBuilder,
  lightmap: readonly [number, number] | undefined,
): Node<"vec3"> | undefined {
  switch (view) {
    case "albedo":
      return "metalness" in material ? diffuseContribution : diffuseColor.rgb;
    case "normal":
      return normalWorld.mul(0.5).add(0.5);
    case "depth":
      return vec3(positionView.z.negate().sub(cameraNear).div(cameraFar.sub(cameraNear)));
    case "lightmap-uv":
      return lightmap ? checker(lightmap) : vec3(0);
    default:
      return undefined;
  }
}

function checker([width, height]: readonly [number, number]): Node<"vec3"> {
  const { lightmapUv } = lightmapPlace();
  const field = lightmapUv.mul(vec3(width / CHECKER_TEXELS, height / CHECKER_TEXELS, 0).xy).floor();
  const isLight = field.x.add(field.y).mod(2).lessThan(0.5);
  return vec3(lightmapUv, 0.5).mul(isLight.select(1, 0.3)) as Node<"vec3">;
}
