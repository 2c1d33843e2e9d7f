/** Settings of the stages of a protocol as sliders: how dense a quench ends, how far a shear goes. */

import type { SettingDescription, SettingValue } from "../engine/gridlock.ts";

type Values = Readonly<Record<string, SettingValue>>;

/** The list of stages, which a slider writes anew. */
export const PROTOCOL = "protocol";

/** The setting of each kind of stage that has a slider. */
const SLIDERS: Readonly<Record<string, string>> = { quench: "packing_fraction", shear: "until_strain" };

/** The key of the description of a setting: "protocol[].until_strain" for "protocol[1].until_strain". */
export function describedKey(key: string): string {
  return key.replace(/\[\d+\]/, "[]");
}

/** The keys of the sliders of a protocol, stage by stage: settings that are given, of the first stage of each kind. */
export function stageKeys(values: Values): string[] {
  const kinds = Array.from({ length: Number(values[PROTOCOL] ?? 0) }, (_, k) => String(values[`${PROTOCOL}[${k}].stage`]));
  return kinds.flatMap((kind, k) => {
    const key = `${PROTOCOL}[${k}].${SLIDERS[kind]}`;
    return kinds.indexOf(kind) === k && typeof values[key] === "number" ? [key] : [];
  });
}

/** The list as TOML with one value changed. */
export function withStageValue(settings: readonly SettingDescription[], values: Values, key: string, value: number): string {
  const described = settings.filter((setting) => setting.table === `${PROTOCOL}[]`);
  const stages = Array.from({ length: Number(values[PROTOCOL] ?? 0) }, (_, k) => {
    const entries = described.flatMap((setting) => {
      const own = setting.key.replace("[]", `[${k}]`);
      const given = own === key ? value : (values[own] ?? null);
      return given === null || given === setting.default ? [] : [`${setting.key.slice(`${PROTOCOL}[].`.length)} = ${JSON.stringify(given)}`];
    });
    return `{ ${entries.join(", ")} }`;
  });
  return `[${stages.join(", ")}]`;
}
