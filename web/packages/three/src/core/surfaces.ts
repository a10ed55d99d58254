/** The meshes of a file, and where in the lightmap each lies. */
import { type BakedLight, expect, type PrimitiveLight, type Rectangle } from "@irradia/runtime";
import {
  BufferGeometry,
  InstancedBufferAttribute,
  type InstancedMesh,
  type Material,
  type Mesh,
  type Object3D,
} from "three";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import { LIGHTMAP_ATTRIBUTES, type LitSurface } from "../types.js";

const NO_PAGE = -1;

/**
 * All meshes under a scene, in order, those of the lightmap with its attributes.
 *
 * @throws InputError where a mesh lacks the uv set that the extension names, or has another number of instances
 */
export function surfacesOf(scene: Object3D, parser: GLTFParser, baked: BakedLight | undefined): LitSurface[] {
  const surfaces: LitSurface[] = [];
  const claimed = new Map<BufferGeometry, PrimitiveLight>();
  const visit = (object: Object3D, node: NodeMeshes): void => {
    const index = parser.associations.get(object)?.nodes;
    const mine = index === undefined ? node : nodeMeshes(baked, index);
    if (isMesh(object)) surfaces.push(surfaceOf(object, mine.next(), claimed));
    for (const child of object.children) visit(child, mine);
  };
  visit(scene, nodeMeshes(baked, undefined));
  return surfaces;
}

/** A mesh without a lightmap. */
export function looseSurface(mesh: Mesh, isDynamic: boolean): LitSurface {
  return { mesh, isDynamic, rectangles: [] };
}

export function isMesh(object: Object3D): object is Mesh {
  return (object as Mesh).isMesh === true;
}

interface NodeMeshes {
  /** What the extension says of the node's next primitive, which GLTFLoader makes in the file's order. */
  next(): PrimitiveLight | undefined;
}

function nodeMeshes(baked: BakedLight | undefined, node: number | undefined): NodeMeshes {
  const primitives = node === undefined ? [] : (baked?.nodes.get(node)?.primitives ?? []);
  let i = 0;
  return { next: () => primitives[i++] };
}

function surfaceOf(
  mesh: Mesh,
  light: PrimitiveLight | undefined,
  claimed: Map<BufferGeometry, PrimitiveLight>,
): LitSurface {
  if (!light) return looseSurface(mesh, false);
  const { rectangles } = light;
  const count = (mesh as InstancedMesh).isInstancedMesh ? (mesh as InstancedMesh).count : 1;
  const found = `${rectangles.length} of lightmap`;
  expect(rectangles.length === count, `expected ${count} rectangles, found ${found}`, `mesh '${mesh.name}'`);
  const other = claimed.get(mesh.geometry);
  if (other) mesh.geometry = sharing(mesh.geometry);
  claimed.set(mesh.geometry, light);
  placeInLightmap(mesh, light);
  return { mesh, isDynamic: false, rectangles };
}

/** Gives a geometry its uv under one name, and its rectangles as attributes that step by instance. */
function placeInLightmap({ geometry, name }: Mesh, { texCoord, rectangles }: PrimitiveLight): void {
  // GLTFLoader's names of TEXCOORD_n
  const uv = geometry.getAttribute(texCoord < 4 ? `uv${texCoord}` : `texcoord_${texCoord}`);
  expect(uv !== undefined, `expected TEXCOORD_${texCoord}, found none`, `mesh '${name}'`);
  const places = rectangles.flatMap((place) => [...(place?.scale ?? [0, 0]), ...(place?.offset ?? [0, 0])]);
  const pages = rectangles.map((place: Rectangle | undefined) => place?.page ?? NO_PAGE);
  geometry.setAttribute(LIGHTMAP_ATTRIBUTES.uv, uv);
  geometry.setAttribute(
    LIGHTMAP_ATTRIBUTES.rectangle,
    new InstancedBufferAttribute(Float32Array.from(places), 4),
  );
  geometry.setAttribute(LIGHTMAP_ATTRIBUTES.page, new InstancedBufferAttribute(Float32Array.from(pages), 1));
}

/** A geometry of the same buffers, for another place in the lightmap. */
function sharing(geometry: BufferGeometry): BufferGeometry {
  const copy = new BufferGeometry();
  copy.name = geometry.name;
  copy.userData = geometry.userData;
  copy.setIndex(geometry.index);
  for (const [name, attribute] of Object.entries(geometry.attributes)) copy.setAttribute(name, attribute);
  copy.morphAttributes = geometry.morphAttributes;
  copy.morphTargetsRelative = geometry.morphTargetsRelative;
  for (const { start, count, materialIndex } of geometry.groups) copy.addGroup(start, count, materialIndex);
  copy.setDrawRange(geometry.drawRange.start, geometry.drawRange.count);
  copy.boundingBox = geometry.boundingBox;
  copy.boundingSphere = geometry.boundingSphere;
  return copy;
}

/** Whether a material shows baked light: lit, and not see-through. */
export function takesLight(material: Material): boolean {
  const kinds = material as Material & Record<string, unknown>;
  const isLit =
    kinds.isMeshStandardMaterial ||
    kinds.isMeshLambertMaterial ||
    kinds.isMeshPhongMaterial ||
    kinds.isMeshToonMaterial;
  const isLitNode = kinds.isNodeMaterial && kinds.lights;
  return Boolean(isLit || isLitNode) && !material.transparent;
}
