import { DARK, LIGHT, type Theme } from "../drawing/overlay.ts";

export type ThemeName = "light" | "dark";
const KEY = "gridlock-theme";

/** Light or dark: what the user has chosen, else what the system says. */
export class ThemeSwitch {
  private readonly listeners: ((theme: Theme) => void)[] = [];
  private readonly system = matchMedia("(prefers-color-scheme: dark)");
  private chosen: ThemeName | null;

  /** `remembers`: whether an earlier choice counts. */
  constructor(remembers = true) {
    const kept = remembers ? readKept() : null;
    this.chosen = kept === "light" || kept === "dark" ? kept : null;
    this.system.addEventListener("change", () => this.apply());
    this.apply();
  }

  get name(): ThemeName {
    return this.chosen ?? (this.system.matches ? "dark" : "light");
  }

  /** Calls back now and whenever it changes. */
  follow(listener: (theme: Theme) => void): void {
    this.listeners.push(listener);
    listener(this.theme);
  }

  toggle(): void {
    this.chosen = this.name === "dark" ? "light" : "dark";
    try {
      localStorage.setItem(KEY, this.chosen);
    } catch {
      // Private windows may keep nothing; the choice then lasts as long as the page.
    }
    this.apply();
  }

  private get theme(): Theme {
    return this.name === "dark" ? DARK : LIGHT;
  }

  private apply(): void {
    document.documentElement.dataset["theme"] = this.name;
    for (const listener of this.listeners) listener(this.theme);
  }
}

function readKept(): string | null {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}
