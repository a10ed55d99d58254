/**
 * State in the URL: `?left=lightmap&right=field:0&compare=split` to begin with, then `#…` with the same keys,
 * so that a link shows again what its sender saw. What is as it would be without is left out.
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
  SURFACES,
  TONES,
  VIEWS,
  type ViewerState,
} from "./state.js";

/** For text that is no value. */
const NONSENSE = Symbol("nonsense");

/** How one value is written. */
interface Codec<T> {
  read(text: string): T | typeof NONSENSE;
  write(value: T): string;
}

const TEXT: Codec<string> = { read: (text) => text, write: (value) => value };
const SWITCH: Codec<boolean> = {
  read: (text) => (text === "1" ? true : text === "0" ? false : NONSENSE),
  write: (value) => (value ? "1" : "0"),
};
/** Nothing at all is a value here: the scene's own camera, an object's own place. */
const POSE: Codec<Pose | undefined> = {
  read: (text) => (text === "" ? undefined : (readPose(text) ?? NONSENSE)),
  write: (pose) => (pose ? writePose(pose) : ""),
};
const PLACE: Codec<Place | undefined> = {
  read: (text) => (text === "" ? undefined : ((numbers(text, 3) as Place | undefined) ?? NONSENSE)),
  write: (place) => place?.map((x) => short(x)).join(",") ?? "",
};
const EXPOSURE: Codec<ViewerState["ev"]> = {
  read: (text) => (text === "auto" || text === "file" ? text : (number(text, -30, 30) ?? NONSENSE)),
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
  surfaces: ["surfaces", oneOf(SURFACES)],
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
  return merged(merged(defaults, search), hash.replace(/^#/, ""));
}

/** The options of the page, which stand before `#`. */
export function readPageOptions(search: string): PageOptions {
  const wanted = new URLSearchParams(search);
  const view = wanted.get("view") ?? "";
  const pose = wanted.get("pose") ?? (/^\d+$/.test(view) ? view : undefined);
  return {
    kiosk: wanted.get("kiosk") === "1",
    backend: BACKENDS.find((backend) => backend === wanted.get("renderer")) ?? "auto",
    pose: pose === undefined ? undefined : number(pose, 0, 1e6),
  };
}

/**
 * What `readState` reads back.
 *
 * @param base what holds without it: what the part before `#` says; it needs no words
 */
export function writeState(state: ViewerState, base = DEFAULTS): string {
  const parts: string[] = [];
  for (const [name, [key, codec]] of Object.entries(CODECS)) {
    const value = state[name as keyof ViewerState];
    const text = (codec as Codec<unknown>).write(value);
    if (text !== (codec as Codec<unknown>).write(base[name as keyof ViewerState])) {
      parts.push(`${key}=${encodeURIComponent(text).replace(/%2C/g, ",").replace(/%3A/g, ":")}`);
    }
  }
  return parts.join("&");
}

/** At most five digits, as few as do. */
export function short(value: number): string {
  return String(Number(value.toPrecision(5)));
}

/** A state with what `text` says about it. */
function merged(base: ViewerState, text: string): ViewerState {
  const wanted = new Map([...new URLSearchParams(text)].map(([key, value]) => [ALIASES[key] ?? key, value]));
  const state: Record<string, unknown> = { ...base };
  for (const [name, [key, codec]] of Object.entries(CODECS)) {
    const word = wanted.get(key);
    const value = word === undefined ? NONSENSE : (codec as Codec<unknown>).read(word);
    if (value !== NONSENSE) state[name] = value;
  }
  return state as unknown as ViewerState;
}

function oneOf<T extends string>(choices: readonly T[]): Codec<T> {
  return { read: (text) => choices.find((choice) => choice === text) ?? NONSENSE, write: (value) => value };
}

function within(lowest: number, highest: number): Codec<number> {
  return { read: (text) => number(text, lowest, highest) ?? NONSENSE, write: short };
}

function number(text: string, lowest: number, highest: number): number | undefined {
  const value = text.trim() === "" ? Number.NaN : Number(text);
  return value >= lowest && value <= highest ? value : undefined;
}

function numbers(text: string, count: number): number[] | undefined {
  const values = text.split(",").map((part) => number(part, -1e9, 1e9));
  return values.length === count && !values.includes(undefined) ? (values as number[]) : undefined;
}
