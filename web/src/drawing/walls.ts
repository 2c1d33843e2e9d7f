import type { Point } from "./frame.ts";

/** A line inside the box that disks meet on both sides. */
export interface Wall {
  readonly from: Point;
  readonly to: Point;
}

/** In pixels: thinner than a wall of the box, so that a disk is seen to touch it. */
export const INNER_WALL_WIDTH = 2;

/** The walls inside the box by the settings of a run as it keeps them, config.resolved.toml: one line before all tables. */
export function wallsIn(configuration: string): Wall[] {
  const line = /^walls = .*$/m.exec(configuration)?.[0] ?? "";
  const pointOf = (text: string | undefined): Point => {
    const [x = NaN, y = NaN] = (text ?? "").split(",").map(Number);
    return { x, y };
  };
  return [...line.matchAll(/from = \[(.*?)\], to = \[(.*?)\]/g)].map(([, from, to]) => ({ from: pointOf(from), to: pointOf(to) }));
}
