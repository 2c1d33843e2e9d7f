import { expect, test } from "vitest";

import type { SourceFrame } from "../../src/sources/source.ts";
import { localBondOrientationOrders } from "../../src/viewer/bond_orientation.ts";
import { namesOfRuns } from "../../src/viewer/run_names.ts";
import { readSeries } from "../../src/sources/table.ts";
import { colouringOf, coloursOf, displacements, gridOf, toDrawn, ValueRange } from "../../src/viewer/colours.ts";

const frame = (ids: number[], columns: SourceFrame["columns"], periodic = true): SourceFrame => ({
  step: 0, time: 0, box: { width: 2, height: 1, periodic }, ids: Float64Array.from(ids), columns, stateHash: "",
});

test("Displacements go over the edges that were crossed", () => {
  const first = frame([1, 2], { x: new Float64Array([0.1, 1.0]), y: new Float64Array([0.5, 0.5]), image_x: new Int32Array([0, 0]), image_y: new Int32Array([0, 0]) });
  const now = frame([1, 2], { x: new Float64Array([1.9, 1.0]), y: new Float64Array([0.5, 0.5]), image_x: new Int32Array([-1, 3]), image_y: new Int32Array([0, 0]) });
  const values = displacements(now, first);
  expect(values[0]).toBeCloseTo(0.2);
  expect(values[1]).toBeCloseTo(6);
});

test("Displacements without images take the shortest, and agents that were not there have none", () => {
  const first = frame([1], { x: new Float64Array([0.1]), y: new Float64Array([0.9]) });
  const now = frame([1, 5], { x: new Float64Array([1.9, 1]), y: new Float64Array([0.1, 0]) });
  const values = displacements(now, first);
  expect(values[0]).toBeCloseTo(Math.hypot(0.2, 0.2));
  expect(values[1]).toBeNaN();
});

test("Displacements in an oblique box lean across its lower and upper edge, with images and without", () => {
  const oblique = (columns: SourceFrame["columns"]): SourceFrame => ({ ...frame([1], columns), box: { width: 2, height: 1, periodic: true, shift: 0.5 } });
  const at = (x: number, y: number): SourceFrame["columns"] => ({ x: new Float64Array([x]), y: new Float64Array([y]) });
  const images = (x: number, y: number): SourceFrame["columns"] => ({ image_x: new Int32Array([x]), image_y: new Int32Array([y]) });
  // From (0.1, 0.9) to (1.9 − 2 + 0.5, 0.1 + 1) = (0.4, 1.1).
  expect(displacements(oblique(at(1.9, 0.1)), oblique(at(0.1, 0.9)))[0]).toBeCloseTo(Math.hypot(0.3, 0.2));
  const first = oblique({ ...at(0.1, 0.9), ...images(0, 0) });
  expect(displacements(oblique({ ...at(1.9, 0.1), ...images(-1, 1) }), first)[0]).toBeCloseTo(Math.hypot(0.3, 0.2));
});

test("Colours are those that the columns allow, and a bar covers all that was shown", () => {
  const columns = { x: new Float64Array([0, 1]), y: new Float64Array([0, 0]), velocity_x: new Float64Array([3, 0]), velocity_y: new Float64Array([4, 1]), species: new Uint32Array([0, 2]) };
  expect(coloursOf(Object.keys(columns), 2).map((one) => one.value)).toEqual(["plain", "displacement", "psi6", "speed", "direction", "velocity_x", "velocity_y", "species"]);
  expect(coloursOf(["x", "y"], 1).map((one) => one.value)).toEqual(["plain", "psi6"]);
  const range = new ValueRange();
  const speed = colouringOf(frame([0, 1], columns), "speed", range, undefined);
  expect(speed).toMatchObject({ by: "values", least: 1, most: 5 });
  const slower = { ...columns, velocity_x: new Float64Array([1, 0]), velocity_y: new Float64Array([0, 0]) };
  expect(colouringOf(frame([0, 1], slower), "speed", range, undefined)).toMatchObject({ least: 0, most: 5 });
  expect(colouringOf(frame([0, 1], columns), "species", range, undefined)).toMatchObject({ by: "kinds" });
  expect(colouringOf(frame([0, 1], columns), "species", range, undefined, { species: ["ant", "bee"] })).toMatchObject({ names: ["ant", "bee"] });
  expect(colouringOf(frame([0, 1], columns), "species", range, undefined, { kind: ["ant"] })).toMatchObject({ names: [] });
  expect(colouringOf(frame([0, 1], columns), "nonsense", range, undefined)).toEqual({ by: "plain" });
});

test("The sixfold order is one in a triangular lattice, whatever edges it crosses, and zero in a square one", () => {
  const [across, up] = [12, 8];
  const rows = [...Array(across * up).keys()];
  const height = Math.sqrt(3) / 2;
  const triangular: SourceFrame = {
    ...frame(rows, {
      x: Float64Array.from(rows, (row) => (row % across) + (Math.floor(row / across) % 2) / 2),
      y: Float64Array.from(rows, (row) => (Math.floor(row / across) + 0.5) * height),
    }),
    box: { width: across, height: up * height, periodic: true },
  };
  for (const value of localBondOrientationOrders(triangular)) expect(value).toBeCloseTo(1, 6);
  // Seven rows end half a spacing farther to the right than they begin.
  const seven = rows.slice(0, 7 * across);
  const oblique: SourceFrame = {
    ...frame(seven, { x: (triangular.columns["x"] as Float64Array).slice(0, seven.length), y: (triangular.columns["y"] as Float64Array).slice(0, seven.length) }),
    box: { width: across, height: 7 * height, periodic: true, shift: 0.5 },
  };
  for (const shift of [0.5, -5.5]) {
    for (const value of localBondOrientationOrders({ ...oblique, box: { ...oblique.box, shift } })) expect(value).toBeCloseTo(1, 6);
  }
  const square: SourceFrame = {
    ...frame(rows, { x: Float64Array.from(rows, (row) => row % across), y: Float64Array.from(rows, (row) => Math.floor(row / across)) }),
    box: { width: across, height: up, periodic: true },
  };
  for (const value of localBondOrientationOrders(square)) expect(value).toBeCloseTo(0, 6);
  expect(colouringOf(triangular, "psi6", new ValueRange(), undefined)).toMatchObject({ by: "values", least: 0, most: 1 });
  expect([...localBondOrientationOrders(frame([7], { x: new Float64Array([1]), y: new Float64Array([0.5]) }))]).toEqual([0]);
});

test("The sixfold order is that of all pairs in wide and in tall boxes", () => {
  const count = 60;
  const share = (k: number, step: number): number => (k * step) % 1; // even, and on no lattice
  for (const periodic of [true, false]) {
    for (const [width, height] of [[6, 1], [1, 6]] as const) {
      const x = Float64Array.from({ length: count }, (_, k) => width * share(k, 0.6180339887));
      const y = Float64Array.from({ length: count }, (_, k) => height * share(k, 0.7548776662));
      const found = localBondOrientationOrders({
        ...frame(Array.from({ length: count }, (_, k) => k), { x, y }), box: { width, height, periodic } });
      const reach = Math.min(1.5 * Math.sqrt((2 / Math.sqrt(3)) * width * height / count), periodic ? 0.5 : Infinity);
      for (let i = 0; i < count; ++i) {
        let [real, imaginary, neighbours] = [0, 0, 0];
        for (let j = 0; j < count; ++j) {
          let [dx, dy] = [(x[j] as number) - (x[i] as number), (y[j] as number) - (y[i] as number)];
          if (periodic) [dx, dy] = [dx - width * Math.round(dx / width), dy - height * Math.round(dy / height)];
          if (j === i || Math.hypot(dx, dy) > reach) continue;
          real += Math.cos(6 * Math.atan2(dy, dx));
          imaginary += Math.sin(6 * Math.atan2(dy, dx));
          ++neighbours;
        }
        expect(found[i], `${i} of ${width} × ${height}`).toBeCloseTo(neighbours === 0 ? 0 : Math.hypot(real, imaginary) / neighbours, 5);
      }
    }
  }
});

test("The grid has cells no smaller than the largest agent", () => {
  const place = { x: new Float64Array([1, 1]), y: new Float64Array([0.2, 0.7]) };
  expect(gridOf(frame([1, 2], { ...place, radius: new Float64Array([0.1, 0.15]) }))).toEqual({ columns: 6, rows: 3 });
  expect(gridOf(frame([1, 2], place))).toBeUndefined();
});

test("Runs of a sweep are called by what differs between them", () => {
  const names = namesOfRuns({
    keys: ["disks.packing_fraction", "run.seed", "disks.start"],
    runs: [{ name: "packing_fraction=0.3_seed=1_start=random", values: ["0.3", "1", '"random_insertion"'] }],
  });
  expect([...names]).toEqual([["packing_fraction=0.3_seed=1_start=random", "φ = 0.3, seed = 1, start = random_insertion"]]);
  const alike = namesOfRuns({ keys: ["flocking.radius", "epidemic.radius"], runs: [{ name: "a", values: ["1.0", "2.0"] }] });
  expect(alike.get("a")).toBe("flocking.radius = 1.0, epidemic.radius = 2.0");
});

test("Agents without a size point where they go", () => {
  const drawn = toDrawn(frame([0], { x: new Float64Array([0.5]), y: new Float64Array([0.25]), velocity_x: new Float64Array([0]), velocity_y: new Float64Array([2]) }));
  expect([...(drawn.positions as Float32Array)]).toEqual([0.5, 0.25]);
  expect((drawn.heading as Float32Array)[0]).toBeCloseTo(Math.PI / 2);
  expect(drawn.radius).toBeUndefined();
});

test("A damaged series.csv is refused with the line that is wrong", () => {
  const refusals: [string, string][] = [
    ["", "its first line does not name every column"],
    ["step,value\n0,1.0\n", "it has no column time"],
    ["step,time,speed\n0,0.0,nan\n10,0.5\n", "line 3 has 2 entries for 3 columns"],
    ["step,time,speed\n0,0.0,1.5\n\n", "line 3 has 1 entry for 3 columns"],
    ["step,time,speed\n0,0.0,1.5\n10,0.5,2.x\n", "“2.x” in line 3, column speed, is not a number"],
  ];
  for (const [text, message] of refusals) expect(() => readSeries(text, new Map())).toThrow(message);
});

test("series.csv becomes quantities against time, with gaps where nothing was measured", () => {
  const table = readSeries("step,time,speed\n0,0.0,nan\n10,0.5,2.5\n20,1,\n", new Map([["speed", "length/time"]]));
  expect(table.times).toEqual([0, 0.5, 1]);
  expect(table.quantities).toEqual([{ name: "speed", unit: "length/time", values: [NaN, 2.5, NaN] }]);
});
