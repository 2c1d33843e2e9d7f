import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

import { describe, expect, test } from "vitest";

import { chartsFor, valuesOf } from "../../src/charts/run_charts.ts";
import { numberText, Series } from "../../src/charts/series.ts";
import type { SettingDescription } from "../../src/engine/gridlock.ts";
import { mainKeys, nameOf, placeOf, rangeOf, roundUp, valueAt } from "../../src/playground/controls.ts";
import { canBeFixed, shareOfFixed, SPECIES, withShareOfFixed } from "../../src/playground/fixed_share.ts";
import { stageKeys, withStageValue } from "../../src/playground/stage_settings.ts";
import { GUIDES, namesIn } from "../../src/playground/guides.ts";
import { rowOf } from "../../src/playground/inspector.ts";
import { decodeLink, encodeLink } from "../../src/playground/link.ts";
import { commentAtTop, SCENES, withoutSweep } from "../../src/playground/scenes.ts";
import { Setup } from "../../src/playground/setup.ts";

const FOLDER = join(import.meta.dirname, "../../../scenes");

describe("links", () => {
  test("a link gives back what was put into it, whatever the text", async () => {
    const toml = "# ψ6 of “disks”\ndisks.count = 400\n" + "x".repeat(5000) + "\n";
    const content = { toml, colour: "psi6", grid: true, stepsPerSecond: 200 };
    const hash = await encodeLink(content);
    expect(hash).toMatch(/^#[\w=&.\-%]+$/);
    expect(await decodeLink(hash)).toEqual(content);
    expect(await decodeLink(await encodeLink({ scene: "melting" }))).toEqual({ scene: "melting" });
    const unlimited = { scene: "melting", stepsPerSecond: Infinity };
    expect(await encodeLink(unlimited)).toBe("#scene=melting&speed=unlimited");
    expect(await decodeLink("#scene=melting&speed=unlimited")).toEqual(unlimited);
    expect(await decodeLink("")).toEqual({});
  });

  test("a link of gridlock.playground in Python is read", async () => {
    const hash = "#toml=S8kszi7WS84vzStRsFUwNDDgSgGLFJckFoFElEqKMhPz0ktzEouUuIpK8_SKU1NTgOLGAA&colour=psi6&grid=1";
    const toml = 'disks.count = 100\ndisks.start = "triangular"\nrun.seed = 3';
    expect(await decodeLink(hash)).toEqual({ toml, colour: "psi6", grid: true });
  });

  test("a set-up of the usual length makes a link that fits anywhere", async () => {
    for (const scene of SCENES) expect((await encodeLink({ toml: scene.toml })).length, scene.name).toBeLessThan(1000);
  });

  test("a damaged link says so", async () => {
    const hash = await encodeLink({ toml: "disks.count = 400" });
    for (const damaged of ["#toml=!!!", "#toml=", hash.slice(0, -6), hash.replace("=", "=AAAA")]) {
      await expect(decodeLink(damaged), damaged).rejects.toThrow(/damaged/);
    }
  });

  test("a small link that unpacks to very much is refused without unpacking it all", async () => {
    const hash = await encodeLink({ toml: "0".repeat(50_000_000) });
    expect(hash.length).toBeLessThan(100_000);
    await expect(decodeLink(hash)).rejects.toThrow(/longer than a megabyte/);
  });
});

describe("scenes", () => {
  test("every file of scenes/ is in the page, with the sentence at its top", () => {
    const files = readdirSync(FOLDER)
      .filter((name) => name.endsWith(".toml"))
      .map((name) => name.replace(".toml", ""));
    expect(SCENES.map((scene) => scene.name).sort()).toEqual(files.sort());
    expect(SCENES[0]?.name).toBe("paper");
    for (const scene of SCENES) {
      const text = readFileSync(join(FOLDER, `${scene.name}.toml`), "utf8");
      if (text.startsWith("#")) expect(scene.documentation.length, scene.name).toBeGreaterThan(20);
      expect(scene.toml).not.toMatch(/^\[sweep\]/m);
      if (!text.includes("[sweep]")) expect(scene.toml).toBe(text);
    }
  });

  test("every scene has a guide: what to do, what to look at and a question, in a few sentences", () => {
    expect(Object.keys(GUIDES).sort()).toEqual(SCENES.map((scene) => scene.name).sort());
    for (const [name, guide] of Object.entries(GUIDES)) {
      expect(guide.ask, name).toMatch(/\?/);
      expect(namesIn(guide).length, name).toBeGreaterThan(0);
      for (const part of [guide.act, guide.see, guide.ask]) {
        expect(part.split("*").length % 2, `${name}: asterisks in pairs`).toBe(1);
        expect(part.split(" ").length, `${name}: words`).toBeLessThan(45);
      }
    }
  });

  test("a sweep is taken out wherever it is, and nothing else", () => {
    expect(withoutSweep("a = 1\n\n[sweep]\nrun.seed = [\n  1, 2,\n]\n\n[run]\nsteps = 3\n")).toBe("a = 1\n\n[run]\nsteps = 3\n");
    expect(withoutSweep("[run]\nsteps = 3\n[sweep]\nx = [1]\n")).toBe("[run]\nsteps = 3\n");
    expect(withoutSweep("# [sweep]\n[run]\n")).toBe("# [sweep]\n[run]\n");
    expect(withoutSweep("[ sweep ] # values\nx = [1]\n[ run ]\n")).toBe("[ run ]\n");
    expect(commentAtTop("# One.\n# Two.\n\n# no\nx = 1")).toBe("One. Two.");
  });
});

describe("controls", () => {
  const setting = (over: Partial<SettingDescription>): SettingDescription => ({
    key: "model.x",
    table: "model",
    kind: "number",
    unit: "",
    documentation: "",
    least: -Infinity,
    most: Infinity,
    leastIsAllowed: true,
    mostIsAllowed: true,
    default: null,
    defaultNote: "",
    choices: [],
    ...over,
  });

  test("a slider reaches every value that is shown, and comes back to it", () => {
    const cases: [SettingDescription, number][] = [
      [setting({ key: "disks.packing_fraction" }), 0.7],
      [setting({ key: "disks.count", kind: "integer" }), 841],
      [setting({ least: 0, most: 6.283 }), 1],
      [setting({ least: 0, leastIsAllowed: false }), 0.02],
      [setting({ kind: "integer", default: 400, least: 1 }), 2000],
    ];
    for (const [one, value] of cases) {
      const range = rangeOf(one, value);
      expect(range.least).toBeLessThanOrEqual(value);
      expect(range.most).toBeGreaterThanOrEqual(value);
      expect(valueAt(range, placeOf(range, value))).toBeCloseTo(value, 2);
      if (!one.leastIsAllowed) expect(valueAt(range, 0)).toBeGreaterThan(one.least);
    }
  });

  test("a value outside the usual range widens it", () => {
    expect(rangeOf(setting({ key: "disks.count", kind: "integer" }), 250_000).most).toBe(250_000);
  });

  test("round numbers above a value", () => {
    expect([0.03, 1, 1.1, 7].map(roundUp)).toEqual([0.05, 1, 2, 10]);
  });

  test("changes come as --set takes them, the last of each setting", () => {
    const setup = new Setup("x = 1").with("disks.count", "100").with("run.seed", "2").with("disks.count", "50");
    expect(setup.overrides).toEqual(["disks.count=50", "run.seed=2"]);
    expect(new Setup("x = 1").isChanged).toBe(false);
  });
});

describe("the stages of a protocol", () => {
  const described = ["stage", "packing_fraction", "deformation", "until_strain", "cycles"].map((name) => ({
    key: `protocol[].${name}`,
    table: "protocol[]",
    default: name === "deformation" ? "simple_shear" : null,
  })) as unknown as SettingDescription[];
  const values = {
    protocol: 3,
    "protocol[0].stage": "quench",
    "protocol[0].packing_fraction": 0.86,
    "protocol[0].deformation": "simple_shear",
    "protocol[0].until_strain": null,
    "protocol[1].stage": "quench",
    "protocol[1].packing_fraction": null,
    "protocol[2].stage": "shear",
    "protocol[2].until_strain": 0.2,
    "protocol[2].deformation": "pure_shear",
    "protocol[2].cycles": 3,
  };

  test("have a slider for the packing fraction of the first quench and the strain of the first shear", () => {
    expect(stageKeys(values)).toEqual(["protocol[0].packing_fraction", "protocol[2].until_strain"]);
    expect(stageKeys({})).toEqual([]);
    expect(["protocol[0].packing_fraction", "protocol[2].until_strain"].map(nameOf)).toEqual(["Quench at φ", "Shear to strain γ"]);
  });

  test("are written anew with one value changed and all others as they are", () => {
    expect(withStageValue(described, values, "protocol[2].until_strain", 0.05)).toBe(
      '[{ stage = "quench", packing_fraction = 0.86 }, { stage = "quench" }, { stage = "shear", deformation = "pure_shear", until_strain = 0.05, cycles = 3 }]',
    );
  });
});

describe("the share of fixed disks", () => {
  const ofKinds = (...kinds: [fraction: number, size_ratio: number, fixed: boolean][]): Record<string, number | boolean | string> => ({
    "disks.sizes": "equal",
    protocol: 0,
    [SPECIES]: kinds.length,
    ...Object.fromEntries(
      kinds.flatMap(([fraction, size_ratio, fixed], k) =>
        Object.entries({ fraction, size_ratio, mass: 1, fixed }).map(([name, value]) => [`${SPECIES}[${k}].${name}`, value]),
      ),
    ),
  });

  test("is that of all fixed kinds, and each kind keeps its part of it", () => {
    const values = ofKinds([0.5, 1, true], [0.25, 0.5, true], [0.25, 0.1, false]);
    expect(shareOfFixed(values)).toBe(0.75);
    expect(withShareOfFixed(values, 0.375)).toBe(
      "[{ fraction = 0.25, size_ratio = 1, mass = 1, fixed = true }, { fraction = 0.125, size_ratio = 0.5, mass = 1, fixed = true }, " +
        "{ fraction = 0.625, size_ratio = 0.1, mass = 1, fixed = false }]",
    );
  });

  test("of a run without fixed disks makes some like the first kind, and from nothing they come back", () => {
    expect(shareOfFixed(ofKinds())).toBe(0);
    expect(withShareOfFixed(ofKinds(), 0.25)).toBe(
      "[{ fraction = 0.75, size_ratio = 1, mass = 1, fixed = false }, { fraction = 0.25, size_ratio = 1, mass = 1, fixed = true }]",
    );
    expect(withShareOfFixed(ofKinds([1, 1, false], [0, 2, true]), 0.5)).toContain("{ fraction = 0.5, size_ratio = 2, mass = 1, fixed = true }");
  });

  test("has a slider where disks can be fixed", () => {
    const settings = [SPECIES, "engine.kind", "propulsion.speed", "box.edge_x", "box.edge_y"].map((key) => ({ key })) as SettingDescription[];
    const shown = (more: Record<string, number | string>): boolean => mainKeys(settings, { ...ofKinds(), ...more }).includes(SPECIES);
    expect(shown({ "engine.kind": "stepped" })).toBe(true);
    expect(shown({ "engine.kind": "exact" })).toBe(true);
    expect(shown({ "engine.kind": "stepped", "propulsion.speed": 1 })).toBe(false);
    expect(shown({ "model.kind": "flocking" })).toBe(false);
    expect(canBeFixed({ ...ofKinds(), protocol: 2 })).toBe(false);
    expect(canBeFixed({ ...ofKinds(), "disks.sizes": "uniform" })).toBe(false);
    expect(canBeFixed(ofKinds([1, 1, true]))).toBe(false);
    expect(mainKeys(settings, ofKinds())).toEqual(expect.arrayContaining(["box.edge_x", "box.edge_y"]));
  });
});

describe("series", () => {
  test("rows become columns, a table, and are thinned where they are too many", () => {
    const series = new Series(["step", "time", "value"], 100);
    series.add([0, 0, NaN, 1, 0.5, 2]);
    expect(series.column("value")).toEqual([NaN, 2]);
    expect(series.toCsv()).toBe("step,time,value\n0,0.0,nan\n1,0.5,2.0\n");
    for (let i = 2; i < 1000; ++i) series.add([i, i / 2, i]);
    expect(series.length).toBeLessThanOrEqual(101);
    const steps = series.column("step");
    const gaps = new Set(steps.slice(1).map((step, i) => step - (steps[i] as number)));
    expect(gaps.size).toBe(1);
    series.clear();
    expect(series.length).toBe(0);
  });

  test("numbers have the text that the program gives them", () => {
    const texts: [number, string][] = [
      [0, "0.0"],
      [-0, "-0.0"],
      [1, "1.0"],
      [-2.5, "-2.5"],
      [0.1 + 0.2, "0.30000000000000004"],
      [0.0001, "0.0001"],
      [0.00001, "1e-05"],
      [-1.25e-7, "-1.25e-07"],
      [123456789012345680, "1.2345678901234568e+17"],
      [1e15, "1000000000000000.0"],
      [1e16, "1e+16"],
      [5e-324, "5e-324"],
      [NaN, "nan"],
      [-Infinity, "-inf"],
    ];
    for (const [value, text] of texts) expect(numberText(value)).toBe(text);
  });

  test("quantities of a model that say the same of themselves share a chart, and those of every run have theirs", () => {
    const column = (name: string, documentation = "", unit = ""): { name: string; unit: string; documentation: string } => ({
      name,
      unit,
      documentation,
    });
    const charts = chartsFor([
      column("step"),
      column("time", "", "time"),
      column("agents", "Agents alive."),
      column("infections", "Times since the start."),
      column("births", "Times since the start."),
      column("susceptible", "Agents of this kind."),
      column("infected", "Agents of this kind."),
      column("order", "|Σ heading| / N."),
      column("mean_displacement", "", "sides of the box"),
      column("kinetic_energy"),
      column("wall_pressure", "", "mass / time²"),
      column("virial_pressure", "", "mass / time²"),
    ]);
    expect(charts.map((chart) => chart.curves.map((curve) => curve.name))).toEqual([
      ["susceptible", "infected"],
      ["order"],
      ["infections", "births"],
      ["mean_displacement"],
      ["wall_pressure", "virial_pressure"],
    ]);
  });

  test("observables on request have charts of their own, and each kind of disk does not", () => {
    const names = [
      "largest_cluster_fraction",
      "mean_cluster_size",
      "local_density_mean",
      "local_density_variance_ratio",
      "diffusion_coefficient",
      "temperature_x",
      "temperature_y",
      "temperature_x_kind_1",
      "temperature_y_kind_2",
      "crossings_forward",
      "crossings_backward",
      "flux_forward",
      "flux_backward",
      "net_flux",
    ];
    const charts = chartsFor(names.map((name) => ({ name, unit: "", documentation: name })));
    expect(charts.map((chart) => chart.curves.map((curve) => curve.name))).toEqual([
      ["largest_cluster_fraction"],
      ["local_density_variance_ratio"],
      ["temperature_x", "temperature_y"],
      ["flux_forward", "flux_backward", "net_flux"],
    ]);
  });

  test("pressures are shown as Z where it is known, that of the walls too, and time is named below every chart", () => {
    const names = ["step", "time", "virial_pressure", "compressibility_factor", "wall_pressure"];
    const charts = chartsFor(names.map((name) => ({ name, unit: "", documentation: name })));
    expect(charts.map((chart) => chart.curves.map((curve) => curve.name))).toEqual([
      ["compressibility_factor", "wall_compressibility_factor"],
    ]);
    expect(charts[0]).toMatchObject({ title: "Compressibility factor Z = PA / NkT", unit: "", abscissa: "time" });
    const series = new Series(names);
    // N kT / A = 4: Z = P / 4.
    series.add([0, 0, NaN, NaN, NaN, 1, 0.5, 12, 3, 14]);
    expect(valuesOf(series, "wall_compressibility_factor")).toEqual([NaN, 3.5]);
    expect(valuesOf(series, "compressibility_factor")).toEqual([NaN, 3]);
    const periodic = chartsFor(names.slice(0, 4).map((name) => ({ name, unit: "", documentation: name })));
    expect(periodic.map((chart) => chart.curves.map((curve) => curve.name))).toEqual([["compressibility_factor"]]);
  });
});

test("the row of an id is found among ids with gaps", () => {
  const ids = Float64Array.from([0, 3, 4, 17]);
  expect([0, 3, 17, 5, 99].map((id) => rowOf(ids, id))).toEqual([0, 1, 3, -1, -1]);
});
