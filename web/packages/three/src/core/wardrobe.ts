/** Copies of materials, one for each way in which they are shown. */
import type { LightShader } from "@irradia/runtime";
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
  readonly #lights = new WeakMap<Material, Shading["light"]>();
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

  /** Throws the copies away that are lit so, which no mesh wears. */
  discard(light: LightShader): void {
    for (const copies of this.#copies.values()) {
      for (const [key, copy] of copies) {
        if (this.#lights.get(copy) !== light) continue;
        copy.dispose();
        copies.delete(key);
      }
    }
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
    this.#lights.set(copy, shading.light);
    this.#painter.paint(copy, original, shading, key);
    return copy;
  }

  #idOf(light: object | undefined): number {
    const id = light ? (this.#ids.get(light) ?? nextId()) : 0;
    if (light) this.#ids.set(light, id);
    return id;
  }

  #keyOf({ light, direct, lamps, validity, view, lightmap }: Shading): string {
    const id = [light, direct, lamps, validity].map((part) => this.#idOf(part)).join("+");
    return `irradia-${this.#scene}-${id}-${view ?? "picture"}-${lightmap ? "mapped" : "loose"}`;
  }
}

let lastId = 0;

function nextId(): number {
  lastId += 1;
  return lastId;
}
