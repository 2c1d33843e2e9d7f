/** Elements of the page without a framework. */

type Properties = Record<string, string | number | boolean | ((event: never) => void) | undefined>;

/**
 * An element with attributes, listeners and children: "onclick" adds a listener, "class" and all others are attributes, true is an
 * attribute without a value, false and undefined leave it out.
 */
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  properties: Properties = {},
  ...children: readonly (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (typeof value === "function") made.addEventListener(name.slice(2), value as (event: Event) => void);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== undefined) made.setAttribute(name, String(value));
  }
  made.append(...children);
  return made;
}

const ICONS = {
  run: "M7 4.5v15l12.5-7.5z",
  pause: "M7 5h3.5v14H7zM13.5 5H17v14h-3.5z",
  step: "M5 5v14l9.5-7zM16.5 5H19v14h-2.5z",
  restart: "M5 5h2.5v14H5zM19 5v14L9.5 12z",
  rewind: "M12 5v14L3 12zM21 5v14l-9-7z",
  link: "M10 14a4 4 0 0 0 6 .4l3-3a4 4 0 0 0-5.7-5.700l-1.5 1.500M14 10a4 4 0 0 0-6-.4l-3 3a4 4 0 0 0 5.7 5.700l1.5-1.5",
  save: "M12 4v11M7.5 11 12 15.5 16.5 11M5 19.500h14",
  theme: "M12 3.500a8.5 8.5 0 1 0 0 17zM12 3.500a8.5 8.5 0 0 1 0 17",
  help: "M9 9a3 3 0 1 1 4.5 2.600c-1 .6-1.5 1.2-1.5 2.400M12 17.500v.5",
  fit: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
  measure: "M4 20 20 4M4 20v-5M4 20h5M20 4v5M20 4h-5",
  record: "M12 6a6 6 0 1 0 0 12 6 6 0 0 0 0-12",
  close: "M6 6l12 12M18 6 6 18",
} as const;

export type IconName = keyof typeof ICONS;
const FILLED: readonly IconName[] = ["run", "pause", "step", "restart", "rewind", "record"];

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("class", FILLED.includes(name) ? "icon filled" : "icon");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

/** A button with an icon and a name that readers of the screen say and a hint shows. */
export function iconButton(name: IconName, label: string, onclick: () => void, hint = label): HTMLButtonElement {
  return element("button", { type: "button", class: "icon-button", "aria-label": label, title: hint, onclick }, icon(name));
}

/** A choice of words; `names` says what the words are called. */
export function select(
  label: string,
  options: readonly { value: string; name: string }[],
  value: string,
  onchange: (value: string) => void,
): HTMLSelectElement {
  const made = element("select", { "aria-label": label, onchange: () => onchange(made.value) });
  setOptions(made, options, value);
  return made;
}

export function setOptions(target: HTMLSelectElement, options: readonly { value: string; name: string }[], value: string): void {
  target.replaceChildren(...options.map((one) => element("option", { value: one.value }, one.name)));
  target.value = value;
}

/** "mean_displacement" → "mean displacement". */
export function words(name: string): string {
  return name.replaceAll("_", " ").replaceAll(/\bpsi6\b/g, "ψ6");
}

/** "φ_J" with a J below the line. */
export function subscripts(text: string): (HTMLElement | string)[] {
  return text.split(/_(\w)/).map((part, i) => (i % 2 === 1 ? element("sub", {}, part) : part));
}

/** Thousands parted by thin spaces. */
export function grouped(value: number): string {
  return Math.round(value)
    .toString()
    .replaceAll(/\B(?=(\d{3})+(?!\d))/g, "\u2009");
}
