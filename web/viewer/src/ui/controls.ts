/** Controls of the panel: each shows a value and says when someone wants another. */
import { el } from "./dom.js";

export interface Choice<T extends string> {
  readonly value: T;
  readonly label: string;
  /** What a pointer that rests on it reads. */
  readonly hint?: string;
  readonly isDisabled?: boolean;
}

/** A control on the page; `show` never calls back. */
export interface Control<T> {
  readonly element: HTMLElement;
  show(value: T): void;
}

export interface SelectControl<T extends string> extends Control<T> {
  setChoices(choices: readonly Choice<T>[]): void;
}

let nextId = 0;
const newId = (): string => `control-${nextId++}`;

/** A menu under its label. */
export function select<T extends string>(
  label: string,
  choices: readonly Choice<T>[],
  onPick: (value: T) => void,
): SelectControl<T> {
  const id = newId();
  const menu = el("select", { id, change: () => onPick(menu.value as T) });
  const setChoices = (wanted: readonly Choice<T>[]): void => {
    const value = menu.value;
    menu.replaceChildren(
      ...wanted.map(({ value, label, isDisabled, hint }) =>
        el("option", { value, disabled: isDisabled, title: hint }, label),
      ),
    );
    menu.value = value;
  };
  setChoices(choices);
  const element = el("div", { class: "row" }, el("label", { for: id }, label), menu);
  const show = (value: T): void => {
    menu.value = value;
  };
  return { element, setChoices, show };
}

/** A few words side by side, one of them chosen. */
export function segments<T extends string>(
  label: string,
  choices: readonly Choice<T>[],
  onPick: (value: T) => void,
): Control<T> {
  const group = newId();
  const inputs = choices.map(({ value }) =>
    el("input", { type: "radio", name: group, value, id: `${group}-${value}`, change: () => onPick(value) }),
  );
  const cells = choices.map(({ value, label, hint }, i) =>
    el("span", {}, inputs[i], el("label", { for: `${group}-${value}`, title: hint }, label)),
  );
  const element = el(
    "div",
    { class: "row", role: "radiogroup", "aria-label": label },
    el("span", { class: "label" }, label),
    el("div", { class: "segments" }, ...cells),
  );
  const show = (value: T): void => {
    for (const input of inputs) input.checked = input.value === value;
  };
  return { element, show };
}

export interface SliderOptions {
  readonly min: number;
  readonly max: number;
  readonly step: number;
  readonly format: (value: number) => string;
  /** Where it goes on a double click. */
  readonly rest?: number;
}

/** A slider with its value in words. */
export function slider(
  label: string,
  options: SliderOptions,
  onMove: (value: number) => void,
): Control<number> {
  const id = newId();
  const { min, max, step, format, rest } = options;
  const output = el("output", { for: id });
  const input = el("input", {
    id,
    type: "range",
    min,
    max,
    step,
    input: () => onMove(Number(input.value)),
    dblclick: () => rest !== undefined && onMove(rest),
  });
  const show = (value: number): void => {
    input.value = String(value);
    input.style.setProperty("--filled", `${(100 * (Number(input.value) - min)) / (max - min)}%`);
    output.textContent = format(value);
  };
  const element = el("div", { class: "row slider" }, el("label", { for: id }, label), output, input);
  return { element, show };
}

/** A part of the panel that can be folded. */
export function section(title: string, ...children: HTMLElement[]): HTMLDetailsElement {
  return el("details", { class: "section", open: true }, el("summary", {}, title), ...children);
}

/** A line of words that changes. */
export function note(className = "note"): { element: HTMLElement; show(text: string): void } {
  const element = el("p", { class: className, hidden: true });
  const show = (text: string): void => {
    element.textContent = text;
    element.hidden = text === "";
  };
  return { element, show };
}
