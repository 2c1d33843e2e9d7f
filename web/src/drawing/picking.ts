import { positionAt, radiusAt, toNearestImage, type Frame, type Point } from "./frame.ts";

/** From `from` to `to` by the shortest way: across the edges that are periodic. */
export function shortest(frame: Frame, from: Point, to: Point): Point {
  return toNearestImage(frame.box, to.x - from.x, to.y - from.y);
}

/** The row of the agent at a place, or the nearest one within `tolerance` of its border; null where there is none. */
export function agentAt(frame: Frame, place: Point, tolerance: number): number | null {
  let nearest: number | null = null;
  let least = tolerance;
  for (let row = 0; row < frame.count; ++row) {
    const away = shortest(frame, place, positionAt(frame, row));
    const distance = Math.sqrt(away.x * away.x + away.y * away.y) - radiusAt(frame, row);
    if (distance < least) {
      least = distance;
      nearest = row;
    }
  }
  return nearest;
}

/** The distance between two places. */
export function distance(frame: Frame, from: Point, to: Point): number {
  const away = shortest(frame, from, to);
  return Math.sqrt(away.x * away.x + away.y * away.y);
}
