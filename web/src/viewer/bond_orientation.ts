/** The sixfold order around each agent, of a frame that no engine knows. */

import { numberAt, periodicAxes, toNearestImage, type Numbers } from "../drawing/frame.ts";
import type { SourceFrame } from "../sources/source.ts";

/** Of the spacing of the triangular lattice: midway between its first shell and its second. */
const REACH = 1.5;

/**
 * |ψ6| of each agent, ψ6 the mean of exp(6iθ) over the agents nearer than 1.5 √(2/(√3 ρ)), ρ the number of agents for the area of the box, θ the direction to
 * them; 0 for an agent without any. As `local_bond_orientation_order` of the program has it, in double precision; agents that are not a number have none.
 */
export function localBondOrientationOrders({ columns, ids, box }: SourceFrame): Float32Array {
  const count = ids.length;
  const x = Float64Array.from({ length: count }, (_, row) => numberAt(columns["x"] as Numbers, row));
  const y = Float64Array.from({ length: count }, (_, row) => numberAt(columns["y"] as Numbers, row));
  const spacing = Math.sqrt(((2 / Math.sqrt(3)) * box.width * box.height) / Math.max(1, count));
  const [isPeriodicX, isPeriodicY] = periodicAxes(box);
  const shorter = Math.min(isPeriodicX ? box.width : Infinity, isPeriodicY ? box.height : Infinity);
  const reach = Math.min(REACH * spacing, shorter / 2);
  const cells = new Cells(x, y, box, reach);
  const real = new Float64Array(count);
  const imaginary = new Float64Array(count);
  const neighbours = new Uint32Array(count);
  const towards = (row: number, other: number): void => {
    const { x: dx, y: dy } = toNearestImage(box, (x[other] as number) - (x[row] as number), (y[other] as number) - (y[row] as number));
    const squared = dx * dx + dy * dy;
    if (!(squared > 0) || squared > reach * reach) return;
    // (dx + i dy)² / |d|² to the third power.
    const c = ((dx - dy) * (dx + dy)) / squared;
    const s = (2 * dx * dy) / squared;
    real[row]! += c * (c * c - 3 * s * s);
    imaginary[row]! += s * (3 * c * c - s * s);
    ++neighbours[row]!;
  };
  for (let row = 0; row < count; ++row) cells.forEachNear(row, (other) => towards(row, other));
  return Float32Array.from(ids, (_, row) =>
    neighbours[row] === 0 ? 0 : Math.hypot(real[row] as number, imaginary[row] as number) / (neighbours[row] as number));
}

/** Points sorted by cells that are no smaller than a distance. */
class Cells {
  private readonly columns: number;
  private readonly rows: number;
  private readonly cellOf: Int32Array;
  private readonly begin: Int32Array;
  private readonly sorted: Int32Array;

  constructor(private readonly x: Float64Array, y: Float64Array, private readonly box: SourceFrame["box"], reach: number) {
    this.columns = Math.max(1, Math.floor(box.width / reach));
    this.rows = Math.max(1, Math.floor(box.height / reach));
    this.cellOf = Int32Array.from(x, (value, row) =>
      placeOf(y[row] as number, box.height, this.rows) * this.columns + placeOf(value, box.width, this.columns));
    this.begin = new Int32Array(this.columns * this.rows + 1);
    for (const cell of this.cellOf) ++this.begin[cell + 1]!;
    for (let cell = 0; cell < this.columns * this.rows; ++cell) this.begin[cell + 1]! += this.begin[cell] as number;
    const next = this.begin.slice();
    this.sorted = new Int32Array(x.length);
    this.cellOf.forEach((cell, row) => { this.sorted[next[cell]!++] = row; });
  }

  /** All other points in the cells around that of a point, each once. */
  forEachNear(row: number, visit: (other: number) => void): void {
    const own = this.cellOf[row] as number;
    const ownRow = Math.floor(own / this.columns);
    const [isPeriodicX, isPeriodicY] = periodicAxes(this.box);
    const { width, shift = 0 } = this.box;
    const cells = new Set<number>();
    for (const next of [ownRow - 1, ownRow, ownRow + 1]) {
      const up = next < 0 ? -1 : next >= this.rows ? 1 : 0;
      if (up !== 0 && !isPeriodicY) continue;
      // Across the lower and the upper edge of an oblique box lies another part of the row.
      const x = (this.x[row] as number) - up * shift;
      const column = up === 0 || shift === 0 ? own % this.columns : placeOf(x - width * Math.floor(x / width), width, this.columns);
      for (const one of around(column, this.columns, isPeriodicX)) cells.add((next - up * this.rows) * this.columns + one);
    }
    for (const cell of cells) {
      for (let at = this.begin[cell] as number; at < (this.begin[cell + 1] as number); ++at) {
        const other = this.sorted[at] as number;
        if (other !== row) visit(other);
      }
    }
  }
}

/** The number of the cell of a value from 0 to `side`. */
function placeOf(value: number, side: number, cells: number): number {
  const cell = Math.floor((value / side) * cells);
  return Number.isNaN(cell) ? 0 : Math.min(cells - 1, Math.max(0, cell));
}

function around(place: number, count: number, isPeriodic: boolean): number[] {
  const all = [place - 1, place, place + 1].map((one) => (isPeriodic ? (one + count) % count : one));
  return all.filter((one) => one >= 0 && one < count);
}
