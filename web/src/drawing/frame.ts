/** One moment of a run as the drawing sees it. */

export type Numbers =
  | Float32Array
  | Float64Array
  | Int8Array
  | Uint8Array
  | Int16Array
  | Uint16Array
  | Int32Array
  | Uint32Array
  | BigInt64Array
  | BigUint64Array;

export interface Point {
  readonly x: number;
  readonly y: number;
}

/** The rectangle from (0, 0) to (width, height), in units of length. */
export interface Box {
  readonly width: number;
  readonly height: number;
  /** Along x and along y, or one answer for both. */
  readonly periodic: boolean | readonly [boolean, boolean];
  /** Of an oblique periodic box: by how much the images above are farther to the right, from −width/2 to width/2. 0 where it is absent. */
  readonly shift?: number;
}

/** Whether a box is periodic along x and along y. */
export function periodicAxes({ periodic }: Pick<Box, "periodic">): readonly [boolean, boolean] {
  return typeof periodic === "boolean" ? [periodic, periodic] : periodic;
}

/** From a point to the nearest image of another, whose difference is (dx, dy): across the edges that are periodic. */
export function toNearestImage(box: Box, dx: number, dy: number): Point {
  const { width, height, shift = 0 } = box;
  const [isPeriodicX, isPeriodicY] = periodicAxes(box);
  const up = isPeriodicY ? Math.round(dy / height) : 0;
  const along = dx - up * shift;
  return { x: isPeriodicX ? along - width * Math.round(along / width) : along, y: dy - up * height };
}

/** A disk in a periodic box and its images across the edges that it reaches over: their centres, its own first. */
export function imagesInSight(box: Box, x: number, y: number, radius: number): Point[] {
  const { width, height, shift = 0 } = box;
  const [isPeriodicX, isPeriodicY] = periodicAxes(box);
  const beside = (x: number, y: number): Point[] => {
    const right = !isPeriodicX ? 0 : x < radius ? 1 : x > width - radius ? -1 : 0;
    return right === 0 ? [{ x, y }] : [{ x, y }, { x: x + right * width, y }];
  };
  const up = !isPeriodicY ? 0 : y < radius ? 1 : y > height - radius ? -1 : 0;
  if (up === 0) return beside(x, y);
  const above = x + up * shift;
  return [...beside(x, y), ...beside(shift === 0 ? x : above - width * Math.floor(above / width), y + up * height)];
}

/**
 * Agents row by row: every array has `count` numbers, in one order, and `positions` x and y of each, 2 `count` numbers.
 *
 * `radius` is one number for all agents, or one each; agents without a radius get a mark of the size of `markRadius`.
 * `heading` is the direction of each agent in radians; agents without a radius are then darts that point there.
 */
export interface Frame {
  readonly box: Box;
  readonly count: number;
  readonly positions: Numbers;
  readonly radius?: Numbers | number;
  readonly heading?: Numbers;
  /** Drawn beneath the agents. */
  readonly field?: DrawnField;
}

/** Numbers on a grid of equal cells over the box, row by row from the bottom. */
export interface Field {
  readonly columns: number;
  readonly rows: number;
  readonly values: Numbers;
}

/** The ends of the colours of a field. */
export interface FieldRange {
  readonly least: number;
  readonly most: number;
}

export type DrawnField = Field & FieldRange;

/** The number in a row of any column; 64-bit integers lose what a double cannot hold, which no picture shows. */
export function numberAt(column: Numbers, row: number): number {
  return Number(column[row]);
}

/** A column whose numbers a loop reads as they are: several times faster than numberAt(). */
export function withoutBigInts(column: Numbers): Exclude<Numbers, BigInt64Array | BigUint64Array> {
  return column instanceof BigInt64Array || column instanceof BigUint64Array ? Float64Array.from(column, Number) : column;
}

/** Where an agent is. */
export function positionAt(frame: Frame, row: number): Point {
  return { x: Number(frame.positions[2 * row]), y: Number(frame.positions[2 * row + 1]) };
}

/** The radius of an agent, or that of the mark of agents without one. */
export function radiusAt(frame: Frame, row: number): number {
  const radius = frame.radius;
  if (radius === undefined) return markRadius(frame.box, frame.count);
  return typeof radius === "number" ? radius : Number(radius[row]);
}

/** A third of the distance to the next agent, but neither a dot that nobody sees nor a blot. */
export function markRadius(box: Box, count: number): number {
  const spacing = Math.sqrt((box.width * box.height) / Math.max(1, count));
  const side = Math.sqrt(box.width * box.height);
  return Math.min(Math.max(0.33 * spacing, 0.0015 * side), 0.008 * side);
}
