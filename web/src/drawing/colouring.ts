/** Which colour each agent has, and what the colours mean. */

import { numberAt, periodicAxes, radiusAt, type Box, type Frame, type Numbers } from "./frame.ts";
import {
  colourCircle,
  KIND_COLOURS,
  mixed,
  NEIGHBOURHOOD_COLOURS,
  OKABE_ITO,
  SCALES,
  UNKNOWN_VALUE,
  WHITE,
  type Colour,
  type ScaleName,
} from "./palettes.ts";

/**
 * What agents are coloured by:
 * - "plain": one colour, or one for each of up to six radii;
 * - "neighbourhood": the cell of the grid of columns × rows, such that no two adjacent cells share a colour (Figure 4);
 * - "values": numbers on a bar from `least` to `most`;
 * - "directions": angles in radians around a circle of colours;
 * - "kinds": whole numbers from 0 to 7 with names.
 */
export type Colouring =
  | { readonly by: "plain" }
  | { readonly by: "neighbourhood"; readonly columns: number; readonly rows: number }
  | {
      readonly by: "values";
      readonly label: string;
      readonly values: Numbers;
      readonly least: number;
      readonly most: number;
      readonly scale?: ScaleName;
    }
  | { readonly by: "directions"; readonly label: string; readonly values: Numbers }
  | { readonly by: "kinds"; readonly label: string; readonly values: Numbers; readonly names?: readonly string[] };

/** What a legend says. */
export type Legend =
  | { readonly kind: "none" }
  | {
      readonly kind: "bar";
      readonly label: string;
      readonly least: number;
      readonly most: number;
      readonly colours: readonly Colour[];
    }
  | { readonly kind: "circle"; readonly label: string; readonly colours: readonly Colour[] }
  | { readonly kind: "list"; readonly label: string; readonly entries: readonly { name: string; colour: Colour }[] };

/** A palette, the place in it of each agent, and its legend. */
export interface Paint {
  readonly palette: readonly Colour[];
  readonly places: Uint16Array;
  readonly legend: Legend;
}

export const MOST_KINDS = 8;
const BANDS = 256;
const MOST_RADII = 6;

const bandsOf = (scale: (t: number) => Colour): Colour[] => Array.from({ length: BANDS }, (_, i) => scale(i / (BANDS - 1)));
const SCALE_BANDS: Readonly<Record<ScaleName, readonly Colour[]>> = {
  viridis: bandsOf(SCALES.viridis),
  cividis: bandsOf(SCALES.cividis),
};
const CIRCLE_BANDS = bandsOf(colourCircle);

/**
 * The colour of a cell, such that it shares it with none of the eight cells around it: consecutive columns and rows alternate
 * between two, and the last of an odd periodic ring has a third.
 */
export function neighbourhoodColour(column: number, row: number, columns: number, rows: number, periodic: Box["periodic"]): number {
  const [isPeriodicX, isPeriodicY] = periodicAxes({ periodic });
  const along = (index: number, count: number, isPeriodic: boolean): number =>
    isPeriodic && count % 2 === 1 && count > 1 && index === count - 1 ? 2 : index % 2;
  return along(column, columns, isPeriodicX) + 3 * along(row, rows, isPeriodicY);
}

/** The colours of the agents of a frame. Throws RangeError if there are not as many values as agents. */
export function paint(frame: Frame, colouring: Colouring): Paint {
  if ("values" in colouring && colouring.values.length !== frame.count) {
    throw new RangeError(`${colouring.values.length} values for ${frame.count} agents`);
  }
  switch (colouring.by) {
    case "plain":
      return paintRadii(frame);
    case "neighbourhood":
      return paintNeighbourhoods(frame, colouring.columns, colouring.rows);
    case "values":
      return paintValues(colouring.values, colouring.least, colouring.most, colouring.label, colouring.scale ?? "viridis");
    case "directions":
      return paintDirections(colouring.values, colouring.label);
    case "kinds":
      return paintKinds(colouring.values, colouring.label, colouring.names ?? []);
  }
}

function paintRadii(frame: Frame): Paint {
  const places = new Uint16Array(frame.count);
  const one = [mixed(OKABE_ITO[0] as Colour, WHITE, 0.35)];
  if (frame.radius === undefined || typeof frame.radius === "number") return { palette: one, places, legend: { kind: "none" } };
  const radii = new Set<number>();
  for (let i = 0; i < frame.count && radii.size <= MOST_RADII; ++i) radii.add(radiusAt(frame, i));
  if (radii.size > MOST_RADII) {
    const { least, most } = rangeOf(frame.radius);
    return paintValues(frame.radius, least, most, "radius", "viridis");
  }
  const sorted = [...radii].sort((a, b) => a - b);
  const place = new Map(sorted.map((radius, i) => [radius, i]));
  for (let i = 0; i < frame.count; ++i) places[i] = place.get(radiusAt(frame, i)) ?? 0;
  const palette = sorted.map((_, i) => mixed(OKABE_ITO[i] as Colour, WHITE, 0.35));
  const entries = sorted.map((radius, i) => ({ name: `R = ${Number(radius.toPrecision(4))}`, colour: palette[i] as Colour }));
  return { palette, places, legend: sorted.length < 2 ? { kind: "none" } : { kind: "list", label: "radius", entries } };
}

function paintNeighbourhoods(frame: Frame, columns: number, rows: number): Paint {
  const places = new Uint16Array(frame.count);
  const { positions, box } = frame;
  const index = (value: number, side: number, cells: number): number =>
    Math.min(Math.max(Math.floor((value * cells) / side), 0), cells - 1);
  for (let i = 0; i < frame.count; ++i) {
    const column = index(numberAt(positions, 2 * i), box.width, columns);
    const row = index(numberAt(positions, 2 * i + 1), box.height, rows);
    places[i] = neighbourhoodColour(column, row, columns, rows, box.periodic);
  }
  return { palette: NEIGHBOURHOOD_COLOURS, places, legend: { kind: "none" } };
}

function paintValues(values: Numbers, least: number, most: number, label: string, scale: ScaleName): Paint {
  const colours = SCALE_BANDS[scale];
  const top = most > least ? most : least + Math.max(1, Math.abs(least));
  const places = new Uint16Array(values.length);
  const perUnit = BANDS / (top - least);
  for (let i = 0; i < values.length; ++i) {
    const band = Math.floor((numberAt(values, i) - least) * perUnit);
    places[i] = band >= 0 ? Math.min(band, BANDS - 1) : Number.isNaN(band) ? BANDS : 0;
  }
  return { palette: [...colours, UNKNOWN_VALUE], places, legend: { kind: "bar", label, least, most: top, colours } };
}

function paintDirections(values: Numbers, label: string): Paint {
  const places = new Uint16Array(values.length);
  for (let i = 0; i < values.length; ++i) {
    const turn = numberAt(values, i) / (2 * Math.PI) + 0.5;
    places[i] = Number.isFinite(turn) ? Math.min(Math.floor((turn - Math.floor(turn)) * BANDS), BANDS - 1) : BANDS;
  }
  return { palette: [...CIRCLE_BANDS, UNKNOWN_VALUE], places, legend: { kind: "circle", label, colours: CIRCLE_BANDS } };
}

function paintKinds(values: Numbers, label: string, names: readonly string[]): Paint {
  const places = new Uint16Array(values.length);
  let last = names.length - 1;
  for (let i = 0; i < values.length; ++i) {
    const kind = numberAt(values, i);
    places[i] = kind >= 0 && kind < MOST_KINDS ? kind : MOST_KINDS;
    if (kind < MOST_KINDS && kind > last) last = kind;
  }
  const entries = KIND_COLOURS.slice(0, last + 1).map((colour, i) => ({ name: names[i] ?? String(i), colour }));
  return { palette: [...KIND_COLOURS, UNKNOWN_VALUE], places, legend: { kind: "list", label, entries } };
}

/** The least and the largest finite number of a column; 0 and 1 where there is none. */
export function rangeOf(values: Numbers): { least: number; most: number } {
  let least = Infinity;
  let most = -Infinity;
  for (let i = 0; i < values.length; ++i) {
    const value = numberAt(values, i);
    if (value < least && value > -Infinity) least = value;
    if (value > most && value < Infinity) most = value;
  }
  return least <= most ? { least, most } : { least: 0, most: 1 };
}
