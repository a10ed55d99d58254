/** Copies of materials, one for each way in which they are shown. */
import type { Material, Mesh } from "three";
import type { Painter, Shading } from "./painter.js";
import { takesLight } from "./surfaces.js";

/**
 * Renderers keep programs by material, so a mesh that changes to a copy and back compiles nothing twice. The
 * material of the file itself is never touched.
 */
export class Wardrobe {
  readonly #painter: Painter;
  readonly #scene = nextId();
  readonly #copies = new Map<Material, Map<string, Material>>();
  readonly #originals = new WeakMap<Material, Material>();
  readonly #ids = new WeakMap<object, number>();

  constructor(painter: Painter) {
    this.#painter = painter;
  }

  originalOf(material: Material): Material {
    return this.#originals.get(material) ?? material;
  }

  /** Shows a mesh so. */
  dress(mesh: Mesh, shading: Shading): void {
    const { material } = mesh;
    mesh.material = Array.isArray(material)
      ? material.map((each) => this.#shown(each, shading))
      : this.#shown(material, shading);
  }

  /** Shows a mesh in the material that it came with. */
  undress(mesh: Mesh): void {
    const { material } = mesh;
    mesh.material = Array.isArray(material)
      ? material.map((each) => this.originalOf(each))
      : this.originalOf(material);
  }

  /** Throws all copies away. Meshes that wear one must be dressed anew. */
  clear(): void {
    for (const copies of this.#copies.values()) for (const copy of copies.values()) copy.dispose();
    this.#copies.clear();
  }

  #shown(material: Material, shading: Shading): Material {
    const original = this.originalOf(material);
    if (!takesLight(original) || (!shading.light && !shading.view && !shading.mask)) return original;
    const copies = this.#copies.get(original) ?? new Map<string, Material>();
    this.#copies.set(original, copies);
    const key = this.#keyOf(shading);
    const copy = copies.get(key) ?? this.#copy(original, shading, key);
    copies.set(key, copy);
    return copy;
  }

  #copy(original: Material, shading: Shading, key: string): Material {
    const copy = original.clone();
    this.#originals.set(copy, original);
    this.#painter.paint(copy, original, shading, key);
    return copy;
  }

  #idOf(light: object | undefined): number {
    const id = light ? (this.#ids.get(light) ?? nextId()) : 0;
    if (light) this.#ids.set(light, id);
    return id;
  }

  #keyOf({ light, direct, view, lightmap }: Shading): string {
    const id = `${this.#idOf(light)}+${this.#idOf(direct)}`;
    return `irradia-${this.#scene}-${id}-${view ?? "picture"}-${lightmap ? "mapped" : "loose"}`;
  }
}

let lastId = 0;

function nextId(): number {
  lastId += 1;
  return lastId;
}
