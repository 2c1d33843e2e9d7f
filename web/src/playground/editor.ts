import { element } from "../page/dom.ts";

/** The set-up as a text: shown as the controls change it, and opened as one likes it. */
export class Editor {
  readonly element: HTMLDetailsElement;
  private readonly text = element("textarea", {
    spellcheck: "false",
    autocapitalize: "off",
    autocomplete: "off",
    "aria-label": "The set-up as TOML",
  });
  private isEdited = false;

  constructor(onOpen: (toml: string) => void) {
    const open = (): void => {
      this.isEdited = false;
      onOpen(this.text.value);
    };
    this.text.addEventListener("input", () => {
      this.isEdited = true;
    });
    this.text.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) open();
    });
    const file = element("input", {
      type: "file",
      accept: ".toml,text/plain",
      class: "visually-hidden",
      tabindex: -1,
      "aria-hidden": "true",
    });
    file.addEventListener("change", () => {
      void file.files?.[0]?.text().then((text) => {
        this.text.value = text;
        open();
      });
      file.value = "";
    });
    const buttons = element(
      "div",
      { class: "buttons" },
      element("button", { type: "button", class: "button primary", onclick: open, title: "Ctrl + Enter" }, "Set up"),
      element("button", { type: "button", class: "button", onclick: () => file.click() }, "Open a file…"),
      file,
    );
    this.element = element("details", {}, element("summary", {}, "Set-up as TOML"), this.text, buttons);
  }

  /** Shows a set-up, unless the user is writing one. */
  show(toml: string, force = false): void {
    if (this.isEdited && !force) return;
    this.isEdited = false;
    this.text.value = toml;
  }

  get value(): string {
    return this.text.value;
  }
}
