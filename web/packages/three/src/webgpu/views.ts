/** Debug views that need no source of light. */
import type { DataArrayTexture } from "three";
import {
  cameraFar,
  cameraNear,
  diffuseColor,
  diffuseContribution,
  float,
  mix,
  normalWorld,
  positionView,
  texture,
  vec3,
} from "three/tsl";
import type { Node, NodeBuilder } from "three/webgpu";
import { CHECKER_TEXELS } from "../core/painter.js";
import { VALIDITY_COLOURS, VALIDITY_SHADE } from "../core/validity.js";
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

/** Colours of the lightmap's texels by how valid they are. */
export function validityView(validity: DataArrayTexture): Node<"vec3"> {
  const { lightmapUv, page } = lightmapPlace();
  const texel = texture(validity, lightmapUv).depth(page.toInt()).level(float(0)) as unknown as Node<"vec4">;
  const code = texel.r.mul(255);
  const { outside, hidden, whole } = VALIDITY_COLOURS;
  const inChart = mix(vec3(...hidden), vec3(...whole), code.sub(1).div(254));
  const isOutside = page.lessThan(0).or(code.lessThan(0.5));
  const shade = mix(1, normalWorld.y.mul(0.5).add(0.5), VALIDITY_SHADE);
  return (isOutside.select(vec3(...outside), inChart) as Node<"vec3">).mul(shade);
}

function checker([width, height]: readonly [number, number]): Node<"vec3"> {
  const { lightmapUv } = lightmapPlace();
  const field = lightmapUv.mul(vec3(width / CHECKER_TEXELS, height / CHECKER_TEXELS, 0).xy).floor();
  const isLight = field.x.add(field.y).mod(2).lessThan(0.5);
  return vec3(lightmapUv, 0.5).mul(isLight.select(1, 0.3)) as Node<"vec3">;
}
