/** What the agents of a run can be coloured by. */

import { MOST_KINDS, rangeOf, type Colouring } from "../drawing/colouring.ts";
import type { EngineFrame, SessionInfo } from "../engine/engine_client.ts";
import { words } from "../page/dom.ts";
import { roundUp } from "./controls.ts";

/** Made by the page itself; all others are columns that the engine draws. */
export const NEIGHBOURHOOD = "neighbourhood";
export const PLAIN = "plain";
const NAMES: Readonly<Record<string, string>> = { [PLAIN]: "size", psi6: "|ψ6|" };

export function coloursOf(info: SessionInfo): { value: string; name: string }[] {
  // PLAIN shows radii, by colours that tell them apart.
  const columns = info.drawnColumns.map((column) => column.name).filter((name) => name !== "radius");
  const names = [NEIGHBOURHOOD, PLAIN, ...columns];
  return names.map((value) => ({ value, name: NAMES[value] ?? words(value) }));
}

/** The colour where none was asked for: kinds, the direction of motion, displacement, or one colour for all. */
export function usualColour(info: SessionInfo): string {
  const columns = info.drawnColumns;
  const kinds = columns.filter((column) => column.valueNames.length > 0).at(-1);
  if (kinds !== undefined) return kinds.name;
  return ["direction", "displacement"].find((name) => columns.some((column) => column.name === name)) ?? PLAIN;
}

/** The range of a colour bar over time: wide enough for every value, with round ends, and narrower again only where most of it is empty. */
export class BarRange {
  private least = 0;
  private most = 0;
  private of = "";

  reset(): void {
    this.of = "";
  }

  cover(name: string, values: Float32Array): { least: number; most: number } {
    if (name === "psi6") return { least: 0, most: 1 };
    const range = rangeOf(values);
    const most = range.most > 0 ? roundUp(range.most) : 0;
    const least = range.least < 0 ? -roundUp(-range.least) : 0;
    if (name !== this.of || range.most > this.most || range.least < this.least || most < 0.3 * this.most) {
      this.most = most;
      this.least = least;
    }
    this.of = name;
    return { least: this.least, most: this.most };
  }
}

/** How a frame is coloured. */
export function colouringOf(info: SessionInfo, frame: EngineFrame, chosen: string, range: BarRange): Colouring {
  if (chosen === NEIGHBOURHOOD) return { by: "neighbourhood", columns: info.grid.columns, rows: info.grid.rows };
  const column = info.drawnColumns.find((one) => one.name === frame.colourBy);
  if (chosen === PLAIN || column === undefined || frame.colour.length !== frame.count) return { by: "plain" };
  const label = NAMES[column.name] ?? words(column.name);
  const values = frame.colour;
  if (column.name === "direction") return { by: "directions", label, values };
  if (column.valueNames.length > 0) return { by: "kinds", label, values, names: column.valueNames };
  if (isOfKinds(info, column.name, values)) return { by: "kinds", label, values };
  return {
    by: "values",
    label: column.unit === "" ? label : `${label} / ${column.unit}`,
    values,
    ...range.cover(column.name, values),
  };
}

/** Whole numbers that few colours tell apart: a species. */
function isOfKinds(info: SessionInfo, name: string, values: Float32Array): boolean {
  const type = info.columns.find((column) => column.name === name)?.type;
  return type === "uint32" && values.every((value) => value < MOST_KINDS);
}
