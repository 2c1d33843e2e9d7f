/** What the agents of a frame can be coloured by. */

import { MOST_KINDS, rangeOf, type Colouring } from "../drawing/colouring.ts";
import { numberAt, toNearestImage, type Frame, type Numbers, type Point } from "../drawing/frame.ts";
import { words } from "../page/dom.ts";
import type { SourceFrame, ValueNames } from "../sources/source.ts";
import { localBondOrientationOrders } from "./bond_orientation.ts";

export const PLAIN = "plain";
export const DISPLACEMENT = "displacement";
export const SPEED = "speed";
export const DIRECTION = "direction";
export const ORDER = "psi6";
const NO_COLOURS = new Set(["x", "y", "image_x", "image_y", "position_z"]);

/** By the names of the columns: made from them, or one of them. */
export function coloursOf(columns: readonly string[], frames: number): { value: string; name: string }[] {
  const made = [PLAIN];
  if (frames > 1) made.push(DISPLACEMENT);
  if (!columns.includes(ORDER)) made.push(ORDER);
  const motion = columns.includes("velocity_x") && columns.includes("velocity_y") ? [SPEED, DIRECTION]
    : columns.includes("heading_x") ? [DIRECTION] : [];
  made.push(...motion.filter((name) => !columns.includes(name)));
  const names: Readonly<Record<string, string>> = { [PLAIN]: "size", [ORDER]: "|ψ6|" };
  const own = columns.filter((name) => !NO_COLOURS.has(name));
  return [...made, ...own].map((value) => ({ value, name: names[value] ?? words(value) }));
}

/** The direction where agents have headings or no size, else a kind, else the size. */
export function usualColour(columns: readonly string[]): string {
  if (columns.includes(DIRECTION) || columns.includes("heading_x")) return DIRECTION;
  return ["health", "species", "kind"].find((name) => columns.includes(name)) ?? PLAIN;
}

/** The ends of the colour bar: wide enough for all that was shown so far, so that colours mean the same in all frames. */
export class ValueRange {
  private least = 0;
  private most = 0;
  private of = "";

  cover(name: string, values: Numbers): { least: number; most: number } {
    const range = rangeOf(values);
    if (name !== this.of) ({ least: this.least, most: this.most } = range);
    this.of = name;
    this.least = Math.min(this.least, range.least);
    this.most = Math.max(this.most, range.most);
    return { least: this.least, most: this.most };
  }

  reset(): void {
    this.of = "";
  }
}

/** A frame as the drawing wants it. Agents without a size are darts where they have a direction. */
export function toDrawn(frame: SourceFrame): Frame {
  const { columns, ids, box } = frame;
  const x = columns["x"] as Numbers;
  const y = columns["y"] as Numbers;
  const positions = new Float32Array(2 * ids.length);
  for (let row = 0; row < ids.length; ++row) {
    positions[2 * row] = numberAt(x, row);
    positions[2 * row + 1] = numberAt(y, row);
  }
  const radius = columns["radius"];
  const heading = radius === undefined ? directions(frame) : undefined;
  return { box, count: ids.length, positions, ...(radius === undefined ? {} : { radius }), ...(heading === undefined ? {} : { heading }) };
}

function directions({ columns, ids }: SourceFrame): Numbers | undefined {
  const own = columns[DIRECTION];
  const x = columns["heading_x"] ?? columns["velocity_x"];
  const y = columns["heading_y"] ?? columns["velocity_y"];
  if (own !== undefined || x === undefined || y === undefined) return own;
  return Float32Array.from(ids, (_, row) => Math.atan2(numberAt(y, row), numberAt(x, row)));
}

/** How far each agent is from where it was in `first`, over all edges it has crossed where the frames say; NaN for one that was not there. */
export function displacements(frame: SourceFrame, first: SourceFrame): Float32Array {
  const rows = new Map<number, number>();
  first.ids.forEach((id, row) => rows.set(id, row));
  const hasImages = [frame, first].every(({ columns }) => columns["image_x"] !== undefined && columns["image_y"] !== undefined);
  return Float32Array.from(frame.ids, (id, row) => {
    const before = rows.get(id);
    if (before === undefined) return NaN;
    const [now, then] = [placeOf(frame, row, hasImages), placeOf(first, before, hasImages)];
    const [dx, dy] = [now.x - then.x, now.y - then.y];
    const away = hasImages ? { x: dx, y: dy } : toNearestImage(frame.box, dx, dy);
    return Math.hypot(away.x, away.y);
  });
}

/** Where an agent is, over the edges that it has crossed where it has images. */
function placeOf({ box, columns }: SourceFrame, row: number, hasImages: boolean): Point {
  const of = (name: string): number => numberAt(columns[name] as Numbers, row);
  const [right, up] = hasImages ? [of("image_x"), of("image_y")] : [0, 0];
  return { x: of("x") + right * box.width + up * (box.shift ?? 0), y: of("y") + up * box.height };
}

/** The most cells along an edge that a screen shows. */
const MOST_CELLS = 4096;

/** The grid in which neighbours are searched: its cells are no smaller than the largest agent. Nothing where agents have no size. */
export function gridOf({ box, columns, ids }: SourceFrame): { columns: number; rows: number } | undefined {
  const radius = columns["radius"];
  let side = 0;
  for (let row = 0; radius !== undefined && row < ids.length; ++row) side = Math.max(side, 2 * numberAt(radius, row));
  if (!(side > 0)) return undefined;
  const cells = (length: number): number => Math.min(MOST_CELLS, Math.max(1, Math.floor(length / side)));
  return { columns: cells(box.width), rows: cells(box.height) };
}

/** How a frame is coloured; `first` is the first frame of the source, where that is needed; `names` are those of kinds. */
export function colouringOf(frame: SourceFrame, chosen: string, range: ValueRange, first: SourceFrame | undefined,
  names: ValueNames = {}): Colouring {
  const { columns, ids } = frame;
  const label = words(chosen);
  const shown = (values: Numbers): Colouring => ({ by: "values", label, values, ...range.cover(chosen, values) });
  if (chosen === DISPLACEMENT && first !== undefined) return shown(displacements(frame, first));
  const own = columns[chosen];
  if (own === undefined && chosen === ORDER) {
    return { by: "values", label: "|ψ6|", values: localBondOrientationOrders(frame), least: 0, most: 1 };
  }
  if (chosen === DIRECTION) {
    const values = directions(frame);
    return values === undefined ? { by: "plain" } : { by: "directions", label, values };
  }
  if (own === undefined && chosen === SPEED && columns["velocity_x"] !== undefined && columns["velocity_y"] !== undefined) {
    const x = columns["velocity_x"];
    const y = columns["velocity_y"];
    return shown(Float32Array.from(ids, (_, row) => Math.hypot(numberAt(x, row), numberAt(y, row))));
  }
  if (own === undefined) return { by: "plain" };
  return isOfKinds(own) ? { by: "kinds", label, values: own, names: names[chosen] ?? [] } : shown(own);
}

/** Whole numbers that few colours tell apart. */
function isOfKinds(values: Numbers): boolean {
  if (values instanceof Float64Array || values instanceof Float32Array) return false;
  for (let row = 0; row < values.length; ++row) {
    const value = numberAt(values, row);
    if (value < 0 || value >= MOST_KINDS) return false;
  }
  return true;
}
