/** Sliders and choices for the settings of a run. */

import type { SettingDescription, SettingValue } from "../engine/gridlock.ts";
import { element, select, words } from "../page/dom.ts";
import { canBeFixed, SHARE_OF_FIXED, shareOfFixed, SPECIES, withShareOfFixed } from "./fixed_share.ts";
import { describedKey, PROTOCOL, stageKeys, withStageValue } from "./stage_settings.ts";

type Values = Readonly<Record<string, SettingValue>>;

/** From least to most, in steps; `logarithmic` for numbers of many sizes. */
interface Range {
  readonly least: number;
  readonly most: number;
  readonly logarithmic?: boolean;
  readonly integer?: boolean;
}

/** What one drags by hand, of disks of any model that has them. */
const DISK_KEYS = ["disks.count", "disks.start", "velocities.max"];
const ENGINE_KEYS = ["engine.kind", "engine.time_step", "engine.contact"];
/** Whether there is a bath, and what its kind needs. */
const THERMOSTAT_KEYS: Readonly<Record<string, readonly string[]>> = {
  none: ["thermostat.kind"],
  andersen: ["thermostat.kind", "thermostat.temperature", "thermostat.rate"],
  brownian: ["thermostat.kind", "thermostat.temperature", "thermostat.interval"],
  langevin: ["thermostat.kind", "thermostat.temperature", "thermostat.friction"],
  overdamped: ["thermostat.kind", "thermostat.temperature", "thermostat.friction"],
};
/** Of the engine exact: grains. */
const GRAIN_KEYS = ["collisions.restitution", "gravity.y"];
/** Of disks: v₀, and D_R where they swim. */
const PROPULSION_KEYS = ["propulsion.speed", "propulsion.rotational_diffusion"];
const COMMON_KEYS = ["box.edge", "box.edge_x", "box.edge_y", "run.seed"];

const NAMES: Readonly<Record<string, string>> = {
  "disks.packing_fraction": "Packing fraction φ",
  "disks.count": "Number of disks N",
  "disks.start": "Start",
  "velocities.max": "Speed vₘₐₓ",
  "engine.kind": "Engine",
  "engine.time_step": "Time step",
  "engine.contact": "Contact",
  "engine.cells": "Cells k",
  "engine.chains": "Chains",
  "thermostat.kind": "Thermostat",
  "thermostat.temperature": "Temperature kT",
  "thermostat.friction": "Friction γ",
  "potential.kind": "Potential",
  "flow.shear_rate": "Shear rate γ̇",
  "collisions.restitution": "Restitution e",
  "gravity.y": "Gravity",
  "propulsion.speed": "Swim speed v₀",
  "propulsion.rotational_diffusion": "Rotational diffusion D_R",
  [SPECIES]: "Share of fixed disks",
  "box.edge": "Edge of the box",
  "box.edge_x": "Left and right edge",
  "box.edge_y": "Lower and upper edge",
  "run.seed": "Seed",
  "protocol[].packing_fraction": "Quench at φ",
  "protocol[].until_strain": "Shear to strain γ",
};
const RANGES: Readonly<Record<string, Range>> = {
  "disks.packing_fraction": { least: 0.01, most: 0.9 },
  "disks.count": { least: 4, most: 100_000, logarithmic: true, integer: true },
  "velocities.max": { least: 0, most: 5 },
  "engine.time_step": { least: 0.005, most: 0.5, logarithmic: true },
  [SPECIES]: { least: 0, most: 0.9 },
  "propulsion.speed": { least: 0, most: 5 },
  "propulsion.rotational_diffusion": { least: 0, most: 1 },
  "engine.cells": { least: 1, most: 60, integer: true },
  "collisions.restitution": { least: 0.1, most: 1 },
  "flow.shear_rate": { least: 0, most: 0.02 },
  "gravity.y": { least: -10, most: 10 },
  "run.seed": { least: 1, most: 100, integer: true },
  "protocol[].packing_fraction": { least: 0.7, most: 1.1 },
  "protocol[].until_strain": { least: 0.01, most: 0.5 },
};

/** The keys of the controls of a run, the most important first. */
export function mainKeys(settings: readonly SettingDescription[], values: Values): string[] {
  const model = String(values["model.kind"] ?? "disks");
  const known = new Set(settings.map((setting) => setting.key));
  const ofModel = settings.filter((setting) => setting.table === model && isSimple(setting)).map((setting) => setting.key);
  // Disks have a radius or a packing fraction: the other follows.
  const size = typeof values["disks.radius"] === "number" ? "disks.radius" : "disks.packing_fraction";
  return [...new Set([...(model === "disks" ? [size, ...DISK_KEYS, ...stageKeys(values), ...keysOfEngine(values)] : ofModel), ...COMMON_KEYS])].filter((key) =>
    known.has(describedKey(key)),
  );
}

function keysOfEngine(values: Values): string[] {
  const swims = Number(values["propulsion.speed"] ?? 0) > 0;
  const propulsion = PROPULSION_KEYS.filter((key) => swims || key === "propulsion.speed");
  const engine = ENGINE_KEYS.filter((key) => key !== "engine.contact" || (values["engine.kind"] !== "exact" && !swims));
  const ofFixed = canBeFixed(values) ? [SPECIES] : [];
  const kind = String(values["thermostat.kind"] ?? "none");
  if (values["engine.kind"] === "soft") {
    const ofPotential = ["potential.kind", ...(values["potential.kind"] === "inverse_power" ? ["potential.exponent"] : [])];
    const ofSwimmers = kind === "overdamped" && Number(values["flow.shear_rate"] ?? 0) === 0 ? propulsion : [];
    const flow = swims ? [] : ["flow.shear_rate"];
    return ["engine.kind", "engine.time_step", ...ofPotential, ...(THERMOSTAT_KEYS[kind] ?? []), ...flow, ...ofSwimmers];
  }
  if (values["engine.kind"] === "event_chain") return ["engine.kind", "engine.chains"];
  // Under a rule with a time step all disks swim, or none.
  if (values["engine.kind"] !== "exact") return [...engine, ...propulsion, ...(swims ? [] : ofFixed)];
  return [...engine, ...(THERMOSTAT_KEYS[kind] ?? []), ...GRAIN_KEYS, ...ofFixed, ...(kind === "brownian" ? propulsion : [])];
}

function isSimple(setting: SettingDescription): boolean {
  return ["number", "integer", "choice", "switch"].includes(setting.kind);
}

export function nameOf(key: string): string {
  const last = words(key.slice(key.lastIndexOf(".") + 1));
  return NAMES[describedKey(key)] ?? last.charAt(0).toUpperCase() + last.slice(1);
}

/** The range of a slider: what is allowed, or what is reasonable around the value. */
export function rangeOf(setting: SettingDescription, value: number): Range {
  const known = RANGES[describedKey(setting.key)];
  if (known !== undefined) return { ...known, least: Math.min(known.least, value), most: Math.max(known.most, value) };
  const integer = setting.kind === "integer";
  const usual = Math.max(typeof setting.default === "number" ? Math.abs(setting.default) : 0, Math.abs(value)) || 1;
  if (integer && value === 0 && setting.least >= 0) return { least: setting.least, most: Math.min(setting.most, 1000), integer };
  if (integer && usual >= 100)
    return { least: Math.max(1, setting.least), most: Math.min(setting.most, roundUp(20 * usual)), logarithmic: true, integer };
  const least = Number.isFinite(setting.least) && setting.least > -10 * usual ? setting.least : Math.min(0, -4 * usual);
  const most = Number.isFinite(setting.most) && setting.most < 20 * usual ? setting.most : roundUp(4 * usual);
  return { least: setting.leastIsAllowed ? least : least + (most - least) / 1000, most, integer };
}

/** What a user should know of a slider that does not reach all that is allowed. */
function beyond(setting: SettingDescription, { least, most }: Range): string | undefined {
  const isAllowed = setting.least < least - Math.abs(least) / 100 || setting.most > most;
  return isAllowed ? `${setting.documentation} The slider goes from ${least} to ${most}; other numbers can be typed.` : undefined;
}

/** The next of 1, 2, 5 times a power of ten. */
export function roundUp(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const share = value / power;
  return power * (share <= 1 ? 1 : share <= 2 ? 2 : share <= 5 ? 5 : 10);
}

/** One control and the key that it changes. */
interface Control {
  readonly key: string;
  readonly element: HTMLElement;
  update(value: SettingValue): void;
  /** A sentence below it; none where it is empty. */
  setHint?(text: string): void;
}

/**
 * The controls of a run. They show the values of the run; a change calls back with "key=value", at once while a slider is dragged.
 */
export class Controls {
  readonly element = element("div", { class: "group" });
  private controls: Control[] = [];
  private keys = "";
  private values: Values = {};

  constructor(
    private readonly settings: readonly SettingDescription[],
    private readonly onChange: (key: string, value: string) => void,
  ) {}

  /** Shows the values of a run that was opened. */
  show(values: Values, keys: readonly string[] = mainKeys(this.settings, values)): void {
    this.values = values;
    const valueOf = (key: string): SettingValue => (key === SPECIES ? shareOfFixed(values) : (values[key] ?? null));
    if (keys.join() !== this.keys) {
      this.keys = keys.join();
      this.controls = keys.map((key) => this.make(key, valueOf(key)));
      this.element.replaceChildren(...this.controls.map((control) => control.element));
    }
    for (const control of this.controls) control.update(valueOf(control.key));
  }

  /** Says something beside the control of a key, where there is one. */
  setHint(key: string, text: string): void {
    this.controls.find((control) => control.key === key)?.setHint?.(text);
  }

  private make(key: string, value: SettingValue): Control {
    const described = this.settings.find((one) => one.key === describedKey(key)) as SettingDescription;
    const setting = { ...described, key };
    if (setting.choices.length > 0) return this.choice(setting);
    if (setting.kind === "switch") return this.switch(setting);
    if (key === SPECIES) {
      const change = (text: string): void => this.onChange(SPECIES, withShareOfFixed(this.values, Number(text)));
      return this.slider({ ...setting, documentation: SHARE_OF_FIXED }, Number(value), change);
    }
    const number = typeof value === "number" ? value : Number(setting.default ?? 0);
    if (key === describedKey(key)) return this.slider(setting, number);
    return this.slider(setting, number, (text) => this.onChange(PROTOCOL, withStageValue(this.settings, this.values, key, Number(text))));
  }

  private choice(setting: SettingDescription): Control {
    const options = setting.choices
      .filter((value) => value !== "file")
      .map((value) => ({ value, name: value.replaceAll("_", " ") }));
    const name = nameOf(setting.key);
    const made = select(name, options, "", (value) => this.onChange(setting.key, value));
    const field = element(
      "div",
      { class: "field row", title: setting.documentation },
      element("span", { class: "name" }, name),
      made,
    );
    return {
      key: setting.key,
      element: field,
      update: (value) => {
        made.value = String(value);
      },
    };
  }

  private switch(setting: SettingDescription): Control {
    const input = element("input", { type: "checkbox", onchange: () => this.onChange(setting.key, String(input.checked)) });
    const field = element("label", { class: "check", title: setting.documentation }, input, nameOf(setting.key));
    return {
      key: setting.key,
      element: field,
      update: (value) => {
        input.checked = value === true;
      },
    };
  }

  /** `change`: what a number of the slider does. */
  private slider(setting: SettingDescription, value: number, change = (text: string): void => this.onChange(setting.key, text)): Control {
    const range = rangeOf(setting, value);
    const id = `setting-${setting.key.replaceAll(/[^a-z0-9_]/g, "-")}`;
    const name = nameOf(setting.key);
    const slider = element("input", { type: "range", min: 0, max: 1000, step: 1, "aria-label": name, title: beyond(setting, range) });
    const number = element("input", { type: "number", id, step: "any", title: setting.unit });
    const say = (): void => {
      slider.setAttribute("aria-valuetext", number.value);
    };
    slider.addEventListener("input", () => {
      number.value = String(valueAt(range, Number(slider.value) / 1000));
      say();
      change(number.value);
    });
    number.addEventListener("change", () => {
      if (number.value !== "") change(number.value);
    });
    const hint = element("p", { class: "hint wide", hidden: true });
    const field = element(
      "div",
      { class: "field", title: setting.documentation },
      element("label", { for: id }, name),
      number,
      slider,
      hint,
    );
    const update = (now: SettingValue): void => {
      if (typeof now !== "number") return;
      if (document.activeElement !== slider) slider.value = String(Math.round(1000 * placeOf(range, now)));
      if (document.activeElement !== number) number.value = String(Number(now.toPrecision(12)));
      say();
    };
    const setHint = (text: string): void => {
      hint.hidden = text === "";
      hint.textContent = text;
    };
    return { key: setting.key, element: field, update, setHint };
  }
}

/** The value at a place of a slider from 0 to 1, rounded as far as the slider can tell values apart. */
export function valueAt(range: Range, place: number): number {
  const value =
    range.logarithmic === true
      ? range.least * (range.most / range.least) ** place
      : range.least + place * (range.most - range.least);
  if (range.integer === true) return range.logarithmic === true ? Number(Math.round(value).toPrecision(3)) : Math.round(value);
  return Number(value.toPrecision(3));
}

export function placeOf(range: Range, value: number): number {
  const place =
    range.logarithmic === true
      ? Math.log(value / range.least) / Math.log(range.most / range.least)
      : (value - range.least) / (range.most - range.least);
  return Math.min(Math.max(place, 0), 1);
}
