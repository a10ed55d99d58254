/** What sources take, as nodes of a material. */
import {
  attribute,
  bitangentView,
  cameraViewMatrix,
  cameraWorldMatrix,
  float,
  negateOnBackSide,
  normalViewGeometry,
  normalWorld,
  positionWorld,
  tangentView,
  varying,
  vec3,
  vec4,
} from "three/tsl";
import type { Node, NodeBuilder } from "three/webgpu";
import { type Inputs, LIGHTMAP_ATTRIBUTES } from "../types.js";

/** All that the material being built can give; made only when asked for. */
export function inputsOf(builder: NodeBuilder, hasLightmap: boolean): Partial<Inputs<Node>> {
  return {
    position: positionWorld,
    normal: normalWorld,
    get surfaceNormal() {
      return surfaceNormal();
    },
    get tangent() {
      return tangent(builder);
    },
    ...(hasLightmap && lightmapPlace()),
  };
}

/** Where in the lightmap: uv of the page, and the page. */
export function lightmapPlace(): { lightmapUv: Node<"vec2">; page: Node<"float"> } {
  const rectangle = attribute<"vec4">(LIGHTMAP_ATTRIBUTES.rectangle, "vec4");
  const uv = attribute<"vec2">(LIGHTMAP_ATTRIBUTES.uv, "vec2").mul(rectangle.xy).add(rectangle.zw);
  const page = varying(attribute<"float">(LIGHTMAP_ATTRIBUTES.page, "float"));
  return { lightmapUv: varying(uv) as Node<"vec2">, page: page.round() as Node<"float"> };
}

/** The vertices' normal, on the side of the viewer. */
function surfaceNormal(): Node<"vec3"> {
  const facing = negateOnBackSide(normalViewGeometry);
  return facing.transformNormalByInverseViewMatrix(cameraViewMatrix);
}

/** Only where a normal map bends the normal does its direction matter. */
function tangent({ geometry, material }: NodeBuilder): Node<"vec4"> {
  const hasFrame = geometry.hasAttribute("tangent") || geometry.hasAttribute("uv");
  const isBent = "normalMap" in material && material.normalMap;
  if (!hasFrame || !isBent) {
    const normal = surfaceNormal();
    const aside = normal.y
      .abs()
      .lessThan(0.9)
      .select(vec3(0, 1, 0), vec3(1, 0, 0)) as Node<"vec3">;
    return vec4(aside.cross(normal).normalize() as Node<"vec3">, 1);
  }
  const along = tangentView.transformDirection(cameraWorldMatrix);
  const turn = negateOnBackSide(normalViewGeometry)
    .cross(tangentView)
    .dot(bitangentView as unknown as Node<"vec3">);
  return vec4(along as Node<"vec3">, turn.lessThan(0).select(float(-1), float(1)) as Node<"float">);
}
