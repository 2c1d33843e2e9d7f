import type { SettingDescription, SettingValue } from "../engine/gridlock.ts";
import { element } from "../page/dom.ts";

/** One field for every setting that has no control: a name, a value, what it means. */
export class AnySetting {
  readonly element: HTMLDetailsElement;
  private readonly key = element("input", {
    type: "text",
    list: "all-settings",
    "aria-label": "Name of a setting",
    placeholder: "engine.substeps",
    class: "wide",
    autocomplete: "off",
    autocapitalize: "off",
    spellcheck: "false",
  });
  private readonly value = element("input", {
    type: "text",
    "aria-label": "Its value",
    class: "wide",
    autocomplete: "off",
    autocapitalize: "off",
    spellcheck: "false",
  });
  private readonly hint = element("p", { class: "hint" });
  private values: Readonly<Record<string, SettingValue>> = {};

  constructor(
    private readonly settings: readonly SettingDescription[],
    onSet: (key: string, value: string) => void,
  ) {
    const usable = settings.filter((setting) => !setting.key.includes("[]") && setting.kind !== "tables");
    const names = element(
      "datalist",
      { id: "all-settings" },
      ...usable.map((setting) => element("option", { value: setting.key }, setting.documentation)),
    );
    const form = element(
      "form",
      { class: "field" },
      this.key,
      this.value,
      element("button", { type: "submit", class: "button wide" }, "Set"),
      names,
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (this.key.value !== "") onSet(this.key.value.trim(), this.value.value.trim());
    });
    this.key.addEventListener("input", () => this.explain());
    this.element = element("details", {}, element("summary", {}, "Any other setting"), form, this.hint);
  }

  show(values: Readonly<Record<string, SettingValue>>): void {
    this.values = values;
    if (document.activeElement !== this.value) this.explain();
  }

  private explain(): void {
    const setting = this.settings.find((one) => one.key === this.key.value.trim());
    if (setting === undefined) {
      this.hint.textContent = "";
      return;
    }
    const now = this.values[setting.key];
    this.value.value = now === null || now === undefined ? "" : String(now);
    const unit = setting.unit === "" ? "" : ` Unit: ${setting.unit}.`;
    const choices = setting.choices.length === 0 ? "" : ` One of: ${setting.choices.join(", ")}.`;
    const missing = now === null || now === undefined ? ` Now: ${setting.defaultNote}.` : "";
    this.hint.textContent = `${setting.documentation}${choices}${unit}${missing}`;
  }
}
