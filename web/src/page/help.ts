import { element, iconButton } from "./dom.ts";

const KEYS: readonly [string, string][] = [
  ["Space", "run, pause"],
  [".", "single step"],
  [",", "rewind by a second of watching"],
  ["r", "restart"],
  ["c", "next colour"],
  ["g", "grid"],
  ["l", "copy a link to the set-up"],
  ["0", "show the whole box"],
  ["Esc", "select nothing"],
  ["?", "this help"],
];

const LICENCES = Object.values(
  import.meta.glob<string>("../../../licenses/*.txt", { query: "?raw", import: "default", eager: true }),
);

/** What the licences of the parts of this page ask to come with it. */
function licences(): HTMLElement {
  return element(
    "details",
    {},
    element("summary", {}, "Licences of what is inside"),
    element("pre", { class: "licences", tabindex: 0 }, LICENCES.join("\n\n")),
  );
}

/** The dialog of the page's help. */
export function helpDialog(version: () => string): HTMLDialogElement {
  const dialog = element("dialog", { "aria-label": "Help" });
  const keys = element(
    "table",
    {},
    ...KEYS.map(([key, text]) => element("tr", {}, element("td", {}, element("kbd", {}, key)), element("td", {}, text))),
  );
  const about = element("p", { class: "hint" });
  dialog.append(
    element(
      "header",
      {},
      element("strong", {}, "Gridlock in the browser"),
      iconButton("close", "Close", () => dialog.close()),
    ),
    element(
      "p",
      {},
      "The engines and models of the library, compiled to WebAssembly, run on this device. Nothing is sent anywhere. " +
        "The state hash is that of the command line: the same set-up gives the same bits.",
    ),
    element("h2", {}, "Picture"),
    element(
      "p",
      {},
      "Click an agent to see its values and the 3 × 3 cells in which its neighbours are searched. Turn the wheel or pinch to zoom, drag to move, " +
        "double-click to see all. With the picture focused, arrows move it, + and − zoom, Enter selects the agent in the middle.",
    ),
    element("h2", {}, "Time"),
    element(
      "p",
      {},
      "Drag the line of time, or click in a chart, to go to that moment. States are saved as the run proceeds; " +
        "going back restores the last one before it and computes the rest again, to the same bits.",
    ),
    element("h2", {}, "Set-up"),
    element(
      "p",
      {},
      "The address of the page always holds the whole set-up: send it, or keep it as a bookmark. “Set-up as TOML” takes any file of ",
      element("code", {}, "gridlock run"),
      "; without its table [sweep], for a page shows one run.",
    ),
    element("h2", {}, "Keys"),
    keys,
    about,
    licences(),
  );
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  dialog.addEventListener("toggle", () => {
    about.textContent = version() === "" ? "" : `Gridlock ${version()}`;
  });
  return dialog;
}
