/** What the page knows and shows, but no link repeats. */
import type { Problem } from "../files/problem.js";
import type { Model } from "../scene/model.js";
import type { Difference } from "../view/difference.js";
import type { BackendName } from "../view/renderer.js";
import type { Reference, SideChoice } from "../view/sources.js";
import type { Statistic } from "../view/statistics.js";
import type { View } from "./state.js";

export type Phase = "empty" | "loading" | "ready" | "error";

export interface Status {
  readonly phase: Phase;
  /** Whether files are still to come; no picture is ready before. */
  readonly isOpening: boolean;
  /** What is being done, or what went wrong. */
  readonly message: string;
  /** 0 … 1 of a download; undefined where nobody knows. */
  readonly progress: number | undefined;
  /** Names of the manifest's scenes. */
  readonly scenes: readonly string[];
  readonly model: Model | undefined;
  readonly references: readonly Reference[];
  readonly choices: readonly SideChoice[];
  readonly left: SideChoice | undefined;
  readonly right: SideChoice | undefined;
  /** That the source in use can show. */
  readonly views: readonly View[];
  /** In use, whoever chose it. */
  readonly ev: number;
  /** Of two sides; null where they have no pixel in common. */
  readonly difference: Difference | null | undefined;
  readonly statistics: readonly Statistic[];
  /** Where first bounces come from, in words. */
  readonly direct: string;
  /** Whether a side shows a picture that was taken from elsewhere. */
  readonly isOffPose: boolean;
  readonly backend: BackendName | undefined;
  readonly problems: readonly Problem[];
}

export const NO_STATUS: Status = {
  phase: "loading",
  isOpening: true,
  message: "",
  progress: undefined,
  scenes: [],
  model: undefined,
  references: [],
  choices: [],
  left: undefined,
  right: undefined,
  views: ["light"],
  ev: 0,
  difference: undefined,
  statistics: [],
  direct: "",
  isOffPose: false,
  backend: undefined,
  problems: [],
};
