/** Fixed disks as one slider: their share, whatever the kinds of disks of a run are. */

import type { SettingValue } from "../engine/gridlock.ts";

type Values = Readonly<Record<string, SettingValue>>;

/** The list of kinds, which the slider writes anew. */
export const SPECIES = "disks.species";
export const SHARE_OF_FIXED = "Share of the disks that never move, as obstacles for the others.";

interface Kind {
  readonly fraction: number;
  readonly size_ratio: number;
  readonly mass: number;
  readonly fixed: boolean;
}

/** The kinds of a run; one where it lists none. */
function kindsOf(values: Values): Kind[] {
  const count = Number(values[SPECIES] ?? 0);
  if (count === 0) return [{ fraction: 1, size_ratio: 1, mass: 1, fixed: false }];
  return Array.from({ length: count }, (_, k) => {
    const number = (name: string): number => Number(values[`${SPECIES}[${k}].${name}`]);
    return { fraction: number("fraction"), size_ratio: number("size_ratio"), mass: number("mass"), fixed: values[`${SPECIES}[${k}].fixed`] === true };
  });
}

const shareOf = (kinds: readonly Kind[]): number => kinds.reduce((sum, kind) => sum + kind.fraction, 0);

export function shareOfFixed(values: Values): number {
  return shareOf(kindsOf(values).filter((kind) => kind.fixed));
}

/** Whether some disks of the run can be fixed: stages of a protocol move all of them, and sizes without kinds cannot be told apart. */
export function canBeFixed(values: Values): boolean {
  return Number(values["protocol"] ?? 0) === 0 && values["disks.sizes"] === "equal" && kindsOf(values).some((kind) => !kind.fixed);
}

/** The list as TOML where `share` of the disks is fixed: the fixed kinds in the proportion they had, or else one like the first kind. */
export function withShareOfFixed(values: Values, share: number): string {
  const kinds = kindsOf(values);
  if (!kinds.some((kind) => kind.fixed)) kinds.push({ ...(kinds[0] as Kind), fraction: 0, fixed: true });
  const entries = kinds.map((kind) => {
    const alike = kinds.filter((other) => other.fixed === kind.fixed);
    const [part, sum] = [kind.fixed ? share : 1 - share, shareOf(alike)];
    const fraction = sum > 0 ? (kind.fraction * part) / sum : part / alike.length;
    return `{ fraction = ${fraction}, size_ratio = ${kind.size_ratio}, mass = ${kind.mass}, fixed = ${kind.fixed} }`;
  });
  return `[${entries.join(", ")}]`;
}
