/**
 * State in the URL: `?left=lightmap&right=field:0&compare=split` to begin with, then `#…` with the same keys,
 * so that a link shows again what its sender saw. What is as it would be anyway is left out.
 */
import { type Pose, readPose, writePose } from "../camera/pose.js";
import {
  BACKENDS,
  COMPARISONS,
  DEFAULTS,
  NAVIGATIONS,
  OBJECTS,
  PASSES,
  type PageOptions,
  type Place,
  PROBE_VIEWS,
  TONES,
  VIEWS,
  type ViewerState,
} from "./state.js";

/** How one value is written; `read` gives undefined for what makes no sense. */
interface Codec<T> {
  read(text: string): T | undefined;
  write(value: T): string;
}

const TEXT: Codec<string> = { read: (text) => text, write: (value) => value };
const SWITCH: Codec<boolean> = {
  read: (text) => (text === "1" ? true : text === "0" ? false : undefined),
  write: (value) => (value ? "1" : "0"),
};
const POSE: Codec<Pose | undefined> = { read: readPose, write: (pose) => (pose ? writePose(pose) : "") };
const PLACE: Codec<Place | undefined> = {
  read: (text) => numbers(text, 3) as Place | undefined,
  write: (place) => place?.map((x) => short(x)).join(",") ?? "",
};
const EXPOSURE: Codec<ViewerState["ev"]> = {
  read: (text) => (text === "auto" || text === "file" ? text : number(text, -30, 30)),
  write: (ev) => (typeof ev === "number" ? short(ev) : ev),
};

const CODECS: { readonly [K in keyof ViewerState]: readonly [key: string, codec: Codec<ViewerState[K]>] } = {
  scene: ["scene", TEXT],
  field: ["field", TEXT],
  environment: ["env", TEXT],
  left: ["left", TEXT],
  right: ["right", TEXT],
  compare: ["compare", oneOf(COMPARISONS)],
  split: ["split", within(0, 1)],
  gain: ["gain", within(0.1, 1000)],
  view: ["view", oneOf(VIEWS)],
  ev: ["ev", EXPOSURE],
  tone: ["tone", oneOf(TONES)],
  camera: ["camera", POSE],
  navigation: ["nav", oneOf(NAVIGATIONS)],
  probes: ["probes", oneOf(PROBE_VIEWS)],
  object: ["object", oneOf(OBJECTS)],
  place: ["place", PLACE],
  pass: ["pass", oneOf(PASSES)],
  panel: ["panel", SWITCH],
};

/** Other names that people will try. */
const ALIASES: Readonly<Record<string, string>> = { source: "left", exposure: "ev" };

/**
 * The state that a URL asks for; what it says after `#` wins. Values that make no sense are left out.
 *
 * @param search of a location, with or without `?`
 * @param hash of a location, with or without `#`
 * @param defaults what holds where neither says anything
 */
export function readState(search: string, hash: string, defaults = DEFAULTS): ViewerState {
  const wanted = pairs(search, hash);
  const state: Record<string, unknown> = { ...defaults };
  for (const [name, [key, codec]] of Object.entries(CODECS)) {
    const text = wanted.get(key);
    const value = text === undefined ? undefined : (codec as Codec<unknown>).read(text);
    if (value !== undefined) state[name] = value;
  }
  return state as unknown as ViewerState;
}

/** The options of the page, which stand before `#`. */
export function readPageOptions(search: string): PageOptions {
  const wanted = new URLSearchParams(search);
  const view = wanted.get("view") ?? "";
  const pose = wanted.get("pose") ?? (/^\d+$/.test(view) ? view : undefined);
  return {
    kiosk: wanted.get("kiosk") === "1",
    backend: oneOf(BACKENDS).read(wanted.get("renderer") ?? "") ?? "auto",
    pose: pose === undefined ? undefined : number(pose, 0, 1e6),
  };
}

/** What `readState` reads back; empty for the defaults. */
export function writeState(state: ViewerState): string {
  const parts: string[] = [];
  for (const [name, [key, codec]] of Object.entries(CODECS)) {
    const value = state[name as keyof ViewerState];
    const text = (codec as Codec<unknown>).write(value);
    if (text !== (codec as Codec<unknown>).write(DEFAULTS[name as keyof ViewerState])) {
      parts.push(`${key}=${encodeURIComponent(text).replace(/%2C/g, ",").replace(/%3A/g, ":")}`);
    }
  }
  return parts.join("&");
}

/** At most five digits, as few as do. */
export function short(value: number): string {
  return String(Number(value.toPrecision(5)));
}

function pairs(search: string, hash: string): Map<string, string> {
  const all = [...new URLSearchParams(search), ...new URLSearchParams(hash.replace(/^#/, ""))];
  return new Map(all.map(([key, value]) => [ALIASES[key] ?? key, value]));
}

function oneOf<T extends string>(choices: readonly T[]): Codec<T> {
  return { read: (text) => choices.find((choice) => choice === text), write: (value) => value };
}

function within(lowest: number, highest: number): Codec<number> {
  return { read: (text) => number(text, lowest, highest), write: short };
}

function number(text: string, lowest: number, highest: number): number | undefined {
  const value = text.trim() === "" ? Number.NaN : Number(text);
  return value >= lowest && value <= highest ? value : undefined;
}

function numbers(text: string, count: number): number[] | undefined {
  const values = text.split(",").map((part) => number(part, -1e9, 1e9));
  return values.length === count && !values.includes(undefined) ? (values as number[]) : undefined;
}
