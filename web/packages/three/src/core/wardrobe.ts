/** Copies of materials, one for each way in which they are shown. */
import type { LightShader } from "@irradia/runtime";
import type { Material, Mesh } from "three";
import type { Painter, Shading } from "./painter.js";
import { drawTwice, hasReflectance, isSeeThrough } from "./see-through.js";
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
  /** What meshes came with that are drawn twice. */
  readonly #split = new WeakMap<Material[], Material>();
  readonly #keys = new WeakMap<Shading, string>();
  readonly #ids = new WeakMap<object, number>();

  constructor(painter: Painter) {
    this.#painter = painter;
  }

  originalOf(material: Material): Material {
    return this.#originals.get(material) ?? material;
  }

  /** Shows a mesh so. */
  dress(mesh: Mesh, shading: Shading): void {
    const material = this.#wornBy(mesh);
    if (Array.isArray(material)) mesh.material = material.map((each) => this.#shown(each, shading));
    else if (shading.baked && isSeeThrough(material) && drawTwice(mesh))
      mesh.material = this.#parts(material, shading);
    else mesh.material = this.#shown(material, shading);
  }

  /** Shows a mesh in the material that it came with. */
  undress(mesh: Mesh): void {
    const material = this.#wornBy(mesh);
    mesh.material = Array.isArray(material) ? material.map((each) => this.originalOf(each)) : material;
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

  /** Single materials are those of the file. */
  #wornBy({ material }: Mesh): Material | Material[] {
    if (!Array.isArray(material)) return this.originalOf(material);
    return this.#split.get(material) ?? material;
  }

  /** What passes a see-through surface, and its own light. */
  #parts(original: Material, shading: Shading): Material[] {
    const nothing = { light: undefined, direct: undefined, lamps: undefined, mask: undefined };
    const parts = [
      this.#copyOf(original, { ...shading, ...nothing, baked: "passed" }),
      this.#copyOf(original, { ...shading, light: shading.seeThrough, direct: undefined, baked: "added" }),
    ];
    this.#split.set(parts, original);
    return parts;
  }

  #shown(material: Material, shading: Shading): Material {
    const original = this.originalOf(material);
    const baked = hasReflectance(original) && !isSeeThrough(original) ? shading.baked : undefined;
    const isPlain = !shading.light && !shading.view && !shading.mask && !baked;
    return takesLight(original) && !isPlain ? this.#copyOf(original, { ...shading, baked }) : original;
  }

  #copyOf(original: Material, shading: Shading): Material {
    const copies = this.#copies.get(original) ?? new Map<string, Material>();
    this.#copies.set(original, copies);
    const key = this.#keys.get(shading) ?? this.#keyOf(shading);
    this.#keys.set(shading, key);
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

  #keyOf({ light, direct, lamps, validity, view, baked, lightmap }: Shading): string {
    const id = [light, direct, lamps, validity].map((part) => this.#idOf(part)).join("+");
    return `irradia-${this.#scene}-${id}-${view ?? baked ?? "picture"}-${lightmap ? "mapped" : "loose"}`;
  }
}

let lastId = 0;

function nextId(): number {
  lastId += 1;
  return lastId;
}
