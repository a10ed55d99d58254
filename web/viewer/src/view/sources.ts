/** What can stand on either side: sources of light, by the names that @irradia/three gives them, and pictures. */
import type { LightSource } from "@irradia/three/webgpu";
import type { Pose } from "../camera/pose.js";
import type { Picture } from "../files/picture.js";

/** A render to compare with, and from where it was rendered. */
export interface Reference {
  readonly id: string;
  readonly label: string;
  readonly picture: Picture;
  /** Unknown for dropped pictures: then they are taken as they are. */
  readonly pose: Pose | undefined;
}

export interface SideChoice {
  readonly id: string;
  readonly label: string;
  readonly kind: "light" | "picture";
}

const LABELS: Readonly<Record<LightSource["kind"], string>> = {
  lightmap: "Lightmap",
  directional: "Directional lightmap",
  field: "Neural field",
  probes: "Light probes",
  "three-probes": "three.js probe grid",
  none: "No baked light",
};

/** All that both sides can be set to, in the order of the menu. */
export function choicesOf(
  sources: readonly Pick<LightSource, "name" | "kind">[],
  references: readonly Pick<Reference, "id" | "label">[],
): SideChoice[] {
  const lights = sources.map(({ name, kind }): SideChoice => {
    const extra = name === kind ? "" : ` · ${name.replace(/^field:/, "")}`;
    return { id: name, label: LABELS[kind] + extra, kind: "light" };
  });
  const pictures = references.map(({ id, label }): SideChoice => ({ id, label, kind: "picture" }));
  return [...lights, ...pictures];
}

/**
 * The choice that a side's id means; an empty or unknown one is what is best to look at: the first on the left,
 * on the right the first that differs from it, pictures before lights.
 */
export function resolveSides(
  choices: readonly SideChoice[],
  left: string,
  right: string,
): readonly [SideChoice | undefined, SideChoice | undefined] {
  const find = (id: string): SideChoice | undefined => choices.find((choice) => choice.id === id);
  const one = find(left) ?? choices[0];
  const others = choices.filter((choice) => choice !== one && choice.id !== "none");
  const best = others.find(({ kind }) => kind === "picture") ?? others[0] ?? choices.at(-1);
  return [one, find(right) ?? best];
}
