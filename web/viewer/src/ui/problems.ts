/** What was wrong with a file, where, and what to do about it. */
import type { Problem } from "../files/problem.js";
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { el, iconButton } from "./dom.js";

/** @param next what has the keys once the last problem is closed */
export function problems(status: Store<Status>, next: HTMLElement): HTMLElement {
  const element = el("div", { class: "problems", role: "alert" });
  const close = (problem: Problem): void => {
    const left = status.value.problems.filter((one) => one !== problem);
    const { model, isOpening } = status.value;
    const phase = model ? ("ready" as const) : ("empty" as const);
    status.set({ problems: left, ...(left.length === 0 && !isOpening && { phase, message: "" }) });
    (element.querySelector("button") ?? next).focus();
  };
  status.watch(
    ({ problems: all }) => all,
    (all) => {
      element.replaceChildren(...all.map((problem) => card(problem, () => close(problem))));
      element.hidden = all.length === 0;
    },
  );
  return element;
}

function card({ title, finding, where, fix }: Problem, close: () => void): HTMLElement {
  return el(
    "section",
    { class: "problem" },
    el("h2", {}, title),
    iconButton("close", "Close", close),
    el("p", { class: "finding" }, finding),
    where ? el("p", { class: "where" }, el("span", {}, "Where "), el("code", {}, where)) : undefined,
    fix ? el("p", { class: "fix" }, fix) : undefined,
  );
}
