/** A scene's materials, exchanged for a while. */
import type { Material, Mesh, Object3D, Scene } from "three";

type Wearer = Object3D & { material: Material | Material[] };

/**
 * Gives every visible object another material, and the scene no background; the function it returns puts all
 * back.
 *
 * @param other what an object wears instead
 */
export function exchangeMaterials(
  scene: Object3D,
  other: (worn: Material, mesh: Mesh) => Material,
): () => void {
  const worn: [Wearer, Material | Material[]][] = [];
  scene.traverseVisible((object) => {
    const wearer = object as Wearer;
    const { material } = wearer;
    if (!material) return;
    worn.push([wearer, material]);
    wearer.material = Array.isArray(material)
      ? material.map((each) => other(each, object as Mesh))
      : other(material, object as Mesh);
  });
  const { background, overrideMaterial } = scene as Scene;
  if (isScene(scene)) Object.assign(scene, { background: null, overrideMaterial: null });
  return () => {
    for (const [wearer, material] of worn) wearer.material = material;
    if (isScene(scene)) Object.assign(scene, { background, overrideMaterial });
  };
}

function isScene(object: Object3D): object is Scene {
  return (object as Scene).isScene === true;
}
