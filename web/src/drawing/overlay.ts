/** What is drawn over the agents: the box, the walls inside it, the grid, the block of a disk, selections, a ruler, the legend. */

import type { Camera } from "./camera.ts";
import type { Legend } from "./colouring.ts";
import { periodicAxes, positionAt, radiusAt, type Box, type Frame, type Point } from "./frame.ts";
import { toCss, type Colour } from "./palettes.ts";
import { shortest } from "./picking.ts";
import { INNER_WALL_WIDTH, type Wall } from "./walls.ts";

export interface Cell {
  readonly column: number;
  readonly row: number;
}

export interface Block {
  readonly columns: number;
  readonly rows: number;
  readonly cells: readonly Cell[];
  /** Rows of the agents in these cells, and of those among them that touch the agent or are near enough for it to see. */
  readonly agents: readonly number[];
  readonly near: readonly number[];
}

/** Who presses on whom: two rows for each contact, and how strongly. */
export interface Contacts {
  readonly rows: ArrayLike<number>;
  readonly forces: ArrayLike<number>;
}

export interface Overlay {
  /** Those inside the box; the box has its own. */
  readonly walls?: readonly Wall[];
  /** Lines from centre to centre, the thicker the stronger. */
  readonly contacts?: Contacts;
  /** The k × k grid: its columns and rows. */
  readonly grid?: { readonly columns: number; readonly rows: number };
  /** The cells around an agent in which its neighbours are searched (Figure 2), of a grid with or without lines. */
  readonly block?: Block;
  /** Rows of selected agents. */
  readonly selected?: readonly number[];
  /** A measured distance. */
  readonly ruler?: { readonly from: Point; readonly to: Point; readonly label: string };
}

/** The colours of everything that is no agent. */
export interface Theme {
  readonly background: Colour;
  readonly ink: Colour;
  readonly faint: Colour;
  /** Of the block and of selections. */
  readonly accent: Colour;
}

export const LIGHT: Theme = {
  background: [1, 1, 1],
  ink: [0.13, 0.14, 0.16],
  faint: [0.38, 0.41, 0.45],
  accent: [0, 0.31, 0.55],
};
export const DARK: Theme = {
  background: [0.075, 0.086, 0.1],
  ink: [0.9, 0.91, 0.93],
  faint: [0.62, 0.66, 0.71],
  accent: [0.55, 0.83, 1],
};

/** Pixels under the box that the legend takes. */
export const LEGEND_HEIGHT = 46;
const NARROWEST_CELL = 4; // pixels; the lines of a finer grid would hide the agents
const FONT = "12px system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif";

/** Where everything is; the canvas has its pixel ratio set already. */
export interface Place {
  readonly context: CanvasRenderingContext2D;
  readonly camera: Camera;
  readonly frame: Frame;
  readonly theme: Theme;
  readonly width: number;
  readonly height: number;
}

export function drawOverlay(place: Place, overlay: Overlay, legend: Legend): void {
  const { context } = place;
  context.save();
  clipToPicture(place, legend);
  if (overlay.contacts !== undefined) drawContacts(place, overlay.contacts);
  if (overlay.grid !== undefined) drawGrid(place, overlay.grid);
  if (overlay.block !== undefined) drawBlock(place, overlay.block);
  drawBox(place);
  if (overlay.walls !== undefined) drawWalls(place, overlay.walls);
  for (const row of overlay.selected ?? []) drawRing(place, row, 3, place.theme.accent, true);
  if (overlay.ruler !== undefined) drawRuler(place, overlay.ruler);
  context.restore();
  drawLegend(place, legend);
}

function clipToPicture({ context, width, height }: Place, legend: Legend): void {
  context.beginPath();
  context.rect(0, 0, width, legend.kind === "none" ? height : height - LEGEND_HEIGHT);
  context.clip();
}

/** The rectangle of the box in pixels. */
export function boxRectangle(camera: Camera, frame: Frame): { x: number; y: number; width: number; height: number } {
  const corner = camera.toPixels({ x: 0, y: frame.box.height });
  return { x: corner.x, y: corner.y, width: frame.box.width * camera.scale, height: frame.box.height * camera.scale };
}

/** In pixels: a wall is thick, a periodic edge thin and dashed. */
export const borderWidth = (isPeriodic: boolean): number => (isPeriodic ? 1.2 : 3);

/** The four borders of a box. They lie outside of it, so that a disk at the wall is seen to touch and not to overlap it; those of walls cover the corners. */
export function borders(at: { x: number; y: number; width: number; height: number }, box: Box): { from: Point; to: Point; isPeriodic: boolean }[] {
  const [isPeriodicX, isPeriodicY] = periodicAxes(box);
  const [besides, above] = [borderWidth(isPeriodicX), borderWidth(isPeriodicY)];
  const [left, right] = [at.x - besides / 2, at.x + at.width + besides / 2];
  const [top, bottom] = [at.y - above / 2, at.y + at.height + above / 2];
  const [outX, outY] = [isPeriodicY && !isPeriodicX ? 0 : besides / 2, isPeriodicX && !isPeriodicY ? 0 : above / 2];
  return [
    ...[left, right].map((x) => ({ from: { x, y: top - outY }, to: { x, y: bottom + outY }, isPeriodic: isPeriodicX })),
    ...[top, bottom].map((y) => ({ from: { x: left - outX, y }, to: { x: right + outX, y }, isPeriodic: isPeriodicY })),
  ];
}

function drawBox({ context, camera, frame, theme }: Place): void {
  for (const { from, to, isPeriodic } of borders(boxRectangle(camera, frame), frame.box)) {
    context.strokeStyle = toCss(isPeriodic ? theme.faint : theme.ink);
    context.lineWidth = borderWidth(isPeriodic);
    context.setLineDash(isPeriodic ? [6, 4] : []);
    context.beginPath();
    context.moveTo(from.x, from.y);
    context.lineTo(to.x, to.y);
    context.stroke();
  }
  context.setLineDash([]);
}

function drawWalls({ context, camera, theme }: Place, walls: readonly Wall[]): void {
  context.strokeStyle = toCss(theme.ink);
  context.lineWidth = INNER_WALL_WIDTH;
  context.beginPath();
  for (const { from, to } of walls) {
    const [start, end] = [camera.toPixels(from), camera.toPixels(to)];
    context.moveTo(start.x, start.y);
    context.lineTo(end.x, end.y);
  }
  context.stroke();
}

function drawGrid({ context, camera, frame, theme, width, height }: Place, grid: NonNullable<Overlay["grid"]>): void {
  const box = boxRectangle(camera, frame);
  const step = { x: box.width / grid.columns, y: box.height / grid.rows };
  if (step.x < NARROWEST_CELL || step.y < NARROWEST_CELL) return;
  context.strokeStyle = toCss(theme.ink);
  context.globalAlpha = 0.6;
  context.lineWidth = 1;
  context.beginPath();
  for (let column = 1; column < grid.columns; ++column) {
    const x = box.x + column * step.x;
    if (x < 0 || x > width) continue;
    context.moveTo(x, Math.max(box.y, 0));
    context.lineTo(x, Math.min(box.y + box.height, height));
  }
  for (let row = 1; row < grid.rows; ++row) {
    const y = box.y + row * step.y;
    if (y < 0 || y > height) continue;
    context.moveTo(Math.max(box.x, 0), y);
    context.lineTo(Math.min(box.x + box.width, width), y);
  }
  context.stroke();
  context.globalAlpha = 1;
}

/** The ends of a contact in pixels; across an edge both halves, which the box cuts off. */
export function contactLines(camera: Camera, frame: Frame, one: number, other: number): [Point, Point][] {
  const from = positionAt(frame, one);
  const to = positionAt(frame, other);
  const away = shortest(frame, from, to);
  const line = (start: Point, sign: 1 | -1): [Point, Point] => [
    camera.toPixels(start),
    camera.toPixels({ x: start.x + sign * away.x, y: start.y + sign * away.y }),
  ];
  const isAcross = Math.abs(away.x - (to.x - from.x)) + Math.abs(away.y - (to.y - from.y)) > 1e-9 * frame.box.width;
  return isAcross ? [line(from, 1), line(to, -1)] : [line(from, 1)];
}

/** Pixels of the line of a contact: as thick as half a disk's radius at three times the mean force. */
export function contactWidths(camera: Camera, frame: Frame, contacts: Contacts): number[] {
  const forces = Array.from(contacts.forces);
  const mean = forces.reduce((sum, force) => sum + force, 0) / Math.max(1, forces.length);
  const full = (camera.scale * radiusAt(frame, 0)) / 6;
  return forces.map((force) => Math.max(0.75, mean > 0 ? (full * Math.min(force, 3 * mean)) / mean : 0));
}

function drawContacts({ context, camera, frame, theme }: Place, contacts: Contacts): void {
  const box = boxRectangle(camera, frame);
  context.save();
  context.beginPath();
  context.rect(box.x, box.y, box.width, box.height);
  context.clip();
  context.strokeStyle = toCss(theme.ink);
  context.lineCap = "round";
  contactWidths(camera, frame, contacts).forEach((width, i) => {
    context.lineWidth = width;
    context.beginPath();
    for (const [from, to] of contactLines(camera, frame, Number(contacts.rows[2 * i]), Number(contacts.rows[2 * i + 1]))) {
      context.moveTo(from.x, from.y);
      context.lineTo(to.x, to.y);
    }
    context.stroke();
  });
  context.restore();
}

function drawBlock(place: Place, block: Block): void {
  const { context, camera, frame, theme } = place;
  const box = boxRectangle(camera, frame);
  const step = { x: box.width / block.columns, y: box.height / block.rows };
  context.fillStyle = toCss(theme.accent);
  context.strokeStyle = toCss(theme.accent);
  context.lineWidth = 1.5;
  for (const cell of block.cells) {
    const x = box.x + cell.column * step.x;
    const y = box.y + box.height - (cell.row + 1) * step.y;
    context.globalAlpha = 0.14;
    context.fillRect(x, y, step.x, step.y);
    context.globalAlpha = 1;
    context.strokeRect(x, y, step.x, step.y);
  }
  for (const row of block.agents) drawRing(place, row, 1, theme.accent, false);
  for (const row of block.near) drawRing(place, row, 2.5, theme.ink, false);
}

/** Around an agent; with a halo it shows on every colour. */
function drawRing(place: Place, row: number, thickness: number, colour: Colour, hasHalo: boolean): void {
  const { context, camera, frame, theme } = place;
  if (row < 0 || row >= frame.count) return;
  const centre = camera.toPixels(positionAt(frame, row));
  const radius = Math.max(radiusAt(frame, row) * camera.scale, 4);
  context.beginPath();
  context.arc(centre.x, centre.y, radius + thickness / 2 - (hasHalo ? 0 : 0.5), 0, 2 * Math.PI);
  if (hasHalo) {
    context.strokeStyle = toCss(theme.background);
    context.lineWidth = thickness + 2;
    context.stroke();
  }
  context.strokeStyle = toCss(colour);
  context.lineWidth = thickness;
  context.stroke();
}

function drawRuler({ context, camera, theme }: Place, ruler: NonNullable<Overlay["ruler"]>): void {
  const from = camera.toPixels(ruler.from);
  const to = camera.toPixels(ruler.to);
  for (const [colour, thickness] of [
    [theme.background, 5],
    [theme.accent, 2],
  ] as const) {
    context.strokeStyle = toCss(colour);
    context.lineWidth = thickness;
    context.beginPath();
    context.moveTo(from.x, from.y);
    context.lineTo(to.x, to.y);
    context.stroke();
  }
  for (const end of [from, to]) {
    context.beginPath();
    context.arc(end.x, end.y, 3.5, 0, 2 * Math.PI);
    context.fillStyle = toCss(theme.accent);
    context.fill();
  }
  drawLabel(context, theme, ruler.label, { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 - 14 });
}

function drawLabel(context: CanvasRenderingContext2D, theme: Theme, text: string, at: Point): void {
  context.font = FONT;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const width = context.measureText(text).width + 12;
  context.fillStyle = toCss(theme.background);
  context.fillRect(at.x - width / 2, at.y - 10, width, 20);
  context.strokeStyle = toCss(theme.faint);
  context.lineWidth = 1;
  context.strokeRect(at.x - width / 2, at.y - 10, width, 20);
  context.fillStyle = toCss(theme.ink);
  context.fillText(text, at.x, at.y + 0.5);
}

/** One tick of a bar: its place from 0 to 1, and what it says. */
export interface Tick {
  readonly place: number;
  readonly text: string;
}

/** About five round numbers from `least` to `most`: steps of 1, 2 or 5 times a power of ten. */
export function ticks(least: number, most: number): Tick[] {
  const rough = (most - least) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const share = rough / power;
  const step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
  const found: Tick[] = [];
  for (let n = Math.ceil(least / step - 1e-9); n * step <= most + 1e-9 * step; ++n) {
    found.push({ place: (n * step - least) / (most - least), text: shortNumber(n * step) });
  }
  return found;
}

/** At most six digits, without the noise of binary fractions. */
export function shortNumber(value: number): string {
  const text = String(Number(value.toPrecision(6)) + 0);
  return text.replace("-", "−");
}

export const CIRCLE_TICKS: readonly Tick[] = ["−π", "−π/2", "0", "π/2", "π"].map((text, i) => ({ place: i / 4, text }));

/** Where the bar or the list of a legend is. */
export function legendRectangle(width: number, height: number): { x: number; y: number; width: number; height: number } {
  const bar = Math.min(360, width - 120);
  return { x: (width - bar) / 2, y: height - LEGEND_HEIGHT + 10, width: bar, height: 10 };
}

function drawLegend(place: Place, legend: Legend): void {
  if (legend.kind === "none") return;
  if (legend.kind === "list") return drawList(place, legend);
  const { context, theme, width, height } = place;
  const bar = legendRectangle(width, height);
  legend.colours.forEach((colour, i) => {
    const from = bar.x + (i * bar.width) / legend.colours.length;
    context.fillStyle = toCss(colour);
    context.fillRect(from, bar.y, bar.x + bar.width - from, bar.height); // to the end, so that no seam shows
  });
  context.font = FONT;
  context.fillStyle = toCss(theme.faint);
  context.strokeStyle = toCss(theme.faint);
  context.lineWidth = 1;
  context.textBaseline = "top";
  context.textAlign = "center";
  for (const tick of legend.kind === "circle" ? CIRCLE_TICKS : ticks(legend.least, legend.most)) {
    const x = bar.x + tick.place * bar.width;
    context.beginPath();
    context.moveTo(x, bar.y + bar.height);
    context.lineTo(x, bar.y + bar.height + 4);
    context.stroke();
    context.fillText(tick.text, x, bar.y + bar.height + 6);
  }
  context.fillStyle = toCss(theme.ink);
  context.textAlign = "right";
  context.textBaseline = "middle";
  context.fillText(legend.label, bar.x - 12, bar.y + bar.height / 2, Math.max(20, bar.x - 16));
}

function drawList({ context, theme, width, height }: Place, legend: Extract<Legend, { kind: "list" }>): void {
  context.font = FONT;
  context.textAlign = "left";
  context.textBaseline = "middle";
  const widths = legend.entries.map((entry) => context.measureText(entry.name).width + 34);
  const label = context.measureText(legend.label).width + 16;
  let x = Math.max(8, (width - label - widths.reduce((sum, one) => sum + one, 0)) / 2);
  const y = height - LEGEND_HEIGHT / 2;
  context.fillStyle = toCss(theme.ink);
  context.fillText(legend.label, x, y);
  x += label;
  legend.entries.forEach((entry, i) => {
    context.fillStyle = toCss(entry.colour);
    context.fillRect(x, y - 6, 12, 12);
    context.strokeStyle = toCss(theme.faint);
    context.lineWidth = 1;
    context.strokeRect(x, y - 6, 12, 12);
    context.fillStyle = toCss(theme.faint);
    context.fillText(entry.name, x + 18, y);
    x += widths[i] as number;
  });
}
