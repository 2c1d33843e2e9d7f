/** How the runs of a sweep are called: by the values that differ, "φ = 0.3, seed = 1". */

import { words } from "../page/dom.ts";

/** What plan.json of a sweep says. */
export interface SweepPlan {
  readonly keys: readonly string[];
  readonly runs: readonly { readonly name: string; readonly values: readonly string[] }[];
}

/** Quantities with a sign that papers use. */
const SIGNS: Readonly<Record<string, string>> = { "disks.packing_fraction": "φ", "disks.count": "N", "engine.time_step": "Δt", "velocities.max": "vₘₐₓ" };

/** By the names of their directories. */
export function namesOfRuns({ keys, runs }: SweepPlan): Map<string, string> {
  const last = (key: string): string => key.slice(key.lastIndexOf(".") + 1);
  const nameOf = (key: string): string => {
    const isAlone = keys.filter((other) => last(other) === last(key)).length === 1;
    return SIGNS[key] ?? words(isAlone ? last(key) : key);
  };
  const text = (value: string): string => value.replace(/^"(.*)"$/, "$1");
  return new Map(runs.map(({ name, values }) => [name, keys.map((key, at) => `${nameOf(key)} = ${text(values[at] ?? "")}`).join(", ")]));
}
