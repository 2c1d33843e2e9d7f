import { expect, test } from "vitest";

import { chartsOfLevels, chartsOfShear, packingFraction, plain, stagesOf, withError } from "../../src/charts/packing.ts";
import { densityHint } from "../../src/playground/packing_panel.ts";
import { packingOf } from "../../src/sources/protocol_tables.ts";

/** As the program writes them: disks that fly, are quenched and decompressed; of the levels some columns. */
const STAGES = `stage,name,packing_fraction,pressure,jamming_packing_fraction,pair_collisions,work
1,"grow",0.7,9.25,nan,812,1000
2,"quench",0.8600000000000004,0.006366978497201543,nan,0,349
3,"decompress",0.8421140148052857,9.999929762327685e-09,0.8421139810971323,0,66
`;
const LEVELS = `stage,packing_fraction,pressure,contact_number,bulk_modulus,shear_modulus
2,0.86,0.0064,4.44,0.317,0.0195
3,0.86,0.0064,4.44,0.317,0.0196
3,0.848,0.00198,4.25,0.297,0.0200
3,0.84211,1e-08,nan,0.250,0.00027
`;
const SUMMARY = `{"gridlock": "0.2.0", "packing_fraction": 0.8421, "timing": {"seconds": 0.2},
  "jamming_packing_fraction": {"value": 0.8421139810971323, "error": 3.5e-13}, "is_jammed": {"value": 1.0, "error": null}}`;

const tables = packingOf(STAGES, LEVELS, SUMMARY);

test("stages are listed with their names, and a pressure that says whether disks are soft", () => {
  expect(stagesOf(tables)).toEqual([
    { name: "1 grow", packingFraction: 0.7, pressure: 9.25, isSoft: false },
    { name: "2 quench", packingFraction: 0.8600000000000004, pressure: 0.006366978497201543, isSoft: true },
    { name: "3 decompress", packingFraction: 0.8421140148052857, pressure: 9.999929762327685e-9, isSoft: true },
  ]);
  expect(tables.results).toEqual([
    { name: "jamming_packing_fraction", mean: 0.8421139810971323, standardError: 3.5e-13 },
    { name: "is_jammed", mean: 1, standardError: NaN },
  ]);
});

test("pressure and contact number are drawn against φ by stage, and the moduli of the last stage", () => {
  const [pressure, contacts, moduli] = chartsOfLevels(tables);
  expect(pressure?.description).toMatchObject({ title: "Pressure of soft disks", abscissa: "packing fraction φ" });
  expect(pressure?.description.curves).toMatchObject([
    { name: "2 quench", isOnePoint: true },
    { name: "3 decompress", isOnePoint: false },
  ]);
  // In ascending order of φ, as a chart wants it.
  expect(pressure?.columns).toEqual([
    [0.84211, 0.848, 0.86, 0.86],
    [NaN, NaN, 0.0064, NaN],
    [1e-8, 0.00198, NaN, 0.0064],
  ]);
  expect(pressure?.ends).toEqual([0.0064, 1e-8]);
  expect(contacts?.columns[2]).toEqual([NaN, 4.25, NaN, 4.44]);
  expect(moduli?.description).toMatchObject({ title: "Elastic moduli, stage 3 decompress" });
  expect(moduli?.columns).toEqual([
    [0.84211, 0.848, 0.86],
    [0.25, 0.297, 0.317],
    [0.00027, 0.02, 0.0196],
  ]);
  expect(moduli?.ends).toEqual([0.25, 0.00027]);
});

test("stress and pressure are drawn against the strain, and against its path where it goes to and fro", () => {
  const shear = (strains: number[]): string =>
    `stage,strain,shear_stress,pressure\n${strains.map((strain, i) => `3,${strain},${0.5 * strain},${i}`).join("\n")}\n`;
  const [stress, pressure] = chartsOfShear(packingOf(STAGES, LEVELS, SUMMARY, shear([0, 0.25, 0.5])));
  expect(stress?.description).toMatchObject({ title: "Stress against strain", abscissa: "strain γ", curves: [{ name: "3 decompress" }] });
  expect(stress?.columns).toEqual([[0, 0.25, 0.5], [0, 0.125, 0.25]]);
  expect(stress?.ends).toEqual([0.25]);
  expect(pressure?.columns).toEqual([[0, 0.25, 0.5], [0, 1, 2]]);
  const [cycle] = chartsOfShear(packingOf(STAGES, LEVELS, SUMMARY, shear([0, 0.25, 0, -0.25, 0])));
  expect(cycle?.description.abscissa).toBe("path of the strain, Σ |Δγ|");
  expect(cycle?.columns).toEqual([[0, 0.25, 0.5, 0.75, 1], [0, 0.125, 0, -0.125, 0]]);
  expect(chartsOfShear(tables)).toEqual([]);
});

test("hard disks alone have stages, and no charts of soft ones", () => {
  const hard = packingOf(STAGES.split("\n").slice(0, 2).join("\n") + "\n", "", "");
  expect(stagesOf(hard)).toMatchObject([{ name: "1 grow", isSoft: false }]);
  expect(chartsOfLevels(hard)).toEqual([]);
});

test("the packing fraction is that of the radii in a box of unequal sides", () => {
  expect(packingFraction([0.5, 0.25, 0.25], { width: 3, height: 0.5 })).toBeCloseTo((Math.PI * 0.375) / 1.5, 12);
});

test("beside the slider stands the density of the present stage, and nothing without a protocol", () => {
  const box = { width: 3, height: 0.5, periodic: true, shift: 0 };
  const radii = Float32Array.from([0.5, 0.25, 0.25]);
  const hint = (preparation: { fraction: number; what: string; stages: number; finished: number }, isPrepared: boolean): string =>
    densityHint({ box, radii, isPrepared, preparation });
  expect(hint({ fraction: 0.5, what: "quench", stages: 2, finished: 1 }, false)).toBe("Of the start. Now φ = 0.7854, in stage 2 of 2, quench.");
  expect(hint({ fraction: 1, what: "", stages: 2, finished: 2 }, true)).toBe("Of the start. Now φ = 0.7854, after the protocol.");
  expect(hint({ fraction: 1, what: "", stages: 0, finished: 0 }, true)).toBe("");
});

test("numbers have the digits that their errors leave", () => {
  expect(withError(0.8421139810971323, 3.2e-13)).toBe("0.8421139811 ± 3e−13");
  expect(withError(6.4381, 0.012)).toBe("6.438 ± 0.01");
  expect(withError(-0.0012, NaN)).toBe("−0.0012");
  expect(withError(NaN, NaN)).toBe("–");
  expect(plain(1e-8, 3)).toBe("1e−8");
});
