/** Elements in one line. */

type Attributes = Readonly<Record<string, string | number | boolean | ((event: Event) => void) | undefined>>;
export type Child = Node | string | undefined;

/**
 * Makes an element. Functions become listeners of the event that they are named after, true an empty
 * attribute, false and undefined none.
 */
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value !== undefined && value !== false)
      element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children.filter((child) => child !== undefined));
  return element;
}

/** Line drawings on a grid of 20, by the `d` of their path. */
const ICONS = {
  open: "M3 15V5h5l2 2h7v8z",
  camera: "M3 6h3l1.5-2h5L14 6h3v10H3z M10 8a3 3 0 1 0 .01 0z",
  link: "M8.5 11.5l3-3 M9 6.5l1.8-1.8a3 3 0 0 1 4.3 4.3L13.5 10.8 M11 13.5l-1.8 1.8a3 3 0 0 1-4.3-4.3L6.5 9.2",
  help: "M7.2 7.6a2.8 2.8 0 1 1 4 2.5c-.9.5-1.2 1-1.2 1.9 M10 15v.4",
  panel: "M3 4h14v12H3z M12.5 4v12",
  full: "M4 8V4h4 M12 4h4v4 M16 12v4h-4 M8 16H4v-4",
  close: "M5 5l10 10 M15 5L5 15",
} as const;
export type IconName = keyof typeof ICONS;

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 20 20");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

/** A button that shows an icon and says in words what it does. */
export function iconButton(name: IconName, label: string, onClick: () => void): HTMLButtonElement {
  return el(
    "button",
    { class: "icon", type: "button", title: label, "aria-label": label, click: onClick },
    icon(name),
  );
}
