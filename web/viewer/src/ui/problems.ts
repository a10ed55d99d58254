/** What was wrong with a file, where, and what to do about it. */
import type { Problem } from "../files/problem.js";
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { el, iconButton } from "./dom.js";

export function problems(status: Store<Status>): HTMLElement {
  const element = el("div", { class: "problems", role: "alert" });
  const close = (problem: Problem): void => {
    const left = status.value.problems.filter((one) => one !== problem);
    const phase = status.value.model ? "ready" : "empty";
    status.set(left.length > 0 ? { problems: left } : { problems: left, phase, message: "" });
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
