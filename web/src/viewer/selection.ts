import { numberAt, type Numbers } from "../drawing/frame.ts";
import { distance } from "../drawing/picking.ts";
import { element, words } from "../page/dom.ts";
import type { SourceFrame } from "../sources/source.ts";
import { toDrawn } from "./colours.ts";

const MOST = 6;

/** The selection after one more click on an agent: a second one takes it out, and of more than six the first goes. */
export function toggled(ids: readonly number[], id: number): number[] {
  return ids.includes(id) ? ids.filter((one) => one !== id) : [...ids, id].slice(-MOST);
}

/** The selected agents with all their values, and the distance between two of them. */
export class Selection {
  readonly element = element("div", { class: "group" });
  /** The selection has changed. */
  onChange: () => void = () => {};
  private ids: number[] = [];
  private frame: SourceFrame | undefined;
  private readonly several = element("input", { type: "checkbox" });
  private readonly field = element("input", { type: "number", min: 0, step: 1, "aria-label": "Id of an agent to select" });
  private readonly hint = element("p", { class: "hint" });
  private readonly apart = element("p", {});
  private readonly table = element("table", { class: "agents" });

  constructor() {
    this.field.addEventListener("change", () => this.selectById());
    const byId = element("label", { class: "field row" }, element("span", { class: "name" }, "Id"), this.field);
    const several = element("label", { class: "check" }, this.several, "Select several");
    this.element.append(element("h2", {}, "Selected agents"), byId, several, this.hint, this.apart, element("div", { class: "scroll" }, this.table));
    this.render();
  }

  /** Rows of the present frame. */
  get rows(): number[] {
    const { frame } = this;
    return frame === undefined ? [] : this.ids.map((id) => frame.ids.indexOf(id)).filter((row) => row >= 0);
  }

  /** A click: on an agent, or beside all. With several, a second click takes an agent out. */
  pick(row: number | null, adds: boolean): void {
    const id = row === null ? undefined : this.frame?.ids[row];
    if (!adds && !this.several.checked) this.ids = id === undefined ? [] : [id];
    else if (id !== undefined) this.ids = toggled(this.ids, id);
    this.changed();
  }

  clear(): void {
    this.ids = [];
    this.changed();
  }

  show(frame: SourceFrame): void {
    this.frame = frame;
    this.render();
  }

  private selectById(): void {
    const id = this.field.valueAsNumber;
    const row = this.frame?.ids.indexOf(id) ?? -1;
    this.field.setCustomValidity(row < 0 ? "There is no agent of that number in this frame." : "");
    this.field.reportValidity();
    if (row >= 0) this.pick(row, false);
  }

  private changed(): void {
    this.render();
    this.onChange();
  }

  private render(): void {
    const rows = this.rows;
    this.hint.hidden = this.ids.length > 0;
    this.hint.textContent = "Click an agent to see its values.";
    this.apart.hidden = rows.length !== 2;
    if (rows.length === 2) this.apart.textContent = `Distance between centres: ${this.distance(rows as [number, number])}`;
    this.table.hidden = this.ids.length === 0;
    if (this.frame !== undefined) this.table.replaceChildren(...this.lines(this.frame));
  }

  private lines(frame: SourceFrame): HTMLElement[] {
    const head = element("tr", {}, element("th", { scope: "col" }, "id"), ...this.ids.map((id) => element("th", { scope: "col" }, String(id))));
    const rows = this.ids.map((id) => frame.ids.indexOf(id));
    const body = Object.entries(frame.columns).map(([name, column]) =>
      element("tr", {}, element("th", { scope: "row" }, words(name)), ...rows.map((row) => element("td", {}, row < 0 ? "gone" : textOf(column, row)))));
    return [head, ...body];
  }

  private distance([first, second]: [number, number]): string {
    const frame = this.frame as SourceFrame;
    const at = (row: number): { x: number; y: number } => ({ x: numberAt(frame.columns["x"] as Numbers, row), y: numberAt(frame.columns["y"] as Numbers, row) });
    return String(Number(distance(toDrawn(frame), at(first), at(second)).toPrecision(8)));
  }
}

function textOf(column: Numbers, row: number): string {
  const value = column[row];
  return typeof value === "bigint" ? String(value) : String(Number((value as number).toPrecision(8)));
}
