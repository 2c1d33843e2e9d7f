import { element, iconButton } from "./dom.ts";
import { helpDialog } from "./help.ts";
import type { ThemeSwitch } from "./theme.ts";

/** One of the views between which the tabs at the top switch. */
export interface Panel {
  readonly name: string;
  /** Made when it is first shown. Throws what goes wrong, which the page then says. */
  open(): Promise<PanelView>;
}

export interface PanelView {
  readonly element: HTMLElement;
  /** A key that no field has taken; whether it means something here. */
  key?(key: string): boolean;
  /** The address has changed. */
  openLink?(hash: string): void | Promise<void>;
}

const MARK = `<svg class="mark" viewBox="0 0 32 32" aria-hidden="true"><circle cx="8.5" cy="8.5" r="7" fill="#0072b2"/><circle cx="23.5" cy="8.5" r="7" fill="#e69f00"/>
<circle cx="8.5" cy="23.5" r="7" fill="#009e73"/><circle cx="23.5" cy="23.5" r="7" fill="#d55e00"/></svg>`;

/** The bar at the top and the panels below it. */
export class Shell {
  private readonly versionText = element("span", { class: "version", title: "The version of Gridlock in this page, with its commit" });
  private readonly tabs: HTMLButtonElement[] = [];
  private readonly views: (PanelView | undefined)[] = [];
  private readonly main = element("main", { class: "panel", tabindex: -1 });
  private readonly help: HTMLDialogElement;
  private shown = -1;

  constructor(
    host: HTMLElement,
    private readonly panels: readonly Panel[],
    theme: ThemeSwitch,
  ) {
    this.help = helpDialog(() => this.version);
    host.append(this.bar(theme), this.main, this.help);
    document.addEventListener("keydown", (event) => this.key(event));
    // The address may have been noted anew since.
    window.addEventListener("hashchange", ({ newURL }) => void this.views[this.shown]?.openLink?.(new URL(newURL).hash));
  }

  get version(): string {
    return this.versionText.textContent ?? "";
  }

  set version(version: string) {
    this.versionText.textContent = version;
  }

  /** Shows a panel; makes it where it is shown for the first time. */
  async show(index: number): Promise<void> {
    this.shown = index;
    this.tabs.forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === index));
      tab.tabIndex = i === index ? 0 : -1;
    });
    try {
      const view = (this.views[index] ??= await (this.panels[index] as Panel).open());
      if (this.shown === index) this.main.replaceChildren(view.element);
    } catch (error) {
      this.main.replaceChildren(
        element(
          "div",
          { class: "group" },
          element("div", { class: "problem", role: "alert" }, error instanceof Error ? error.message : String(error)),
        ),
      );
    }
  }

  private bar(theme: ThemeSwitch): HTMLElement {
    const title = element("h1", {});
    title.innerHTML = `${MARK}<span>Gridlock</span>`;
    this.panels.forEach((panel, i) =>
      this.tabs.push(
        element("button", { type: "button", class: "tab", role: "tab", onclick: () => void this.show(i) }, panel.name),
      ),
    );
    const tabs = element("div", { class: "tabs", role: "tablist", "aria-label": "Views" }, ...this.tabs);
    tabs.addEventListener("keydown", (event) => {
      const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      if (by === 0) return;
      const next = (this.shown + by + this.tabs.length) % this.tabs.length;
      void this.show(next);
      this.tabs[next]?.focus();
    });
    const themeButton = iconButton("theme", "Light or dark", () => theme.toggle());
    const helpButton = iconButton("help", "Help", () => this.help.showModal(), "Help (?)");
    this.versionText.classList.add("push");
    return element("header", { class: "bar" }, title, tabs, this.versionText, themeButton, helpButton);
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || this.help.open) return;
    const isField = target.matches("input:not([type=range]):not([type=checkbox]), textarea, select");
    // A focused button takes the space bar, and Escape closes its menu.
    if (isField || (event.key === " " && target.matches("button, summary, a, input"))) return;
    if (event.key === "?") this.help.showModal();
    else if (this.views[this.shown]?.key?.(event.key) !== true) return;
    event.preventDefault();
  }
}
