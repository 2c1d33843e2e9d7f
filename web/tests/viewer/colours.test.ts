import { expect, test } from "vitest";

import type { SourceFrame } from "../../src/sources/source.ts";
import { readSeries } from "../../src/sources/table.ts";
import { colouringOf, coloursOf, displacements, toDrawn, ValueRange } from "../../src/viewer/colours.ts";

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

test("Colours are those that the columns allow, and a bar covers all that was shown", () => {
  const columns = { x: new Float64Array([0, 1]), y: new Float64Array([0, 0]), velocity_x: new Float64Array([3, 0]), velocity_y: new Float64Array([4, 1]), species: new Uint32Array([0, 2]) };
  expect(coloursOf(Object.keys(columns), 2).map((one) => one.value)).toEqual(["plain", "displacement", "speed", "direction", "velocity_x", "velocity_y", "species"]);
  expect(coloursOf(["x", "y"], 1).map((one) => one.value)).toEqual(["plain"]);
  const range = new ValueRange();
  const speed = colouringOf(frame([0, 1], columns), "speed", range, undefined);
  expect(speed).toMatchObject({ by: "values", least: 1, most: 5 });
  const slower = { ...columns, velocity_x: new Float64Array([1, 0]), velocity_y: new Float64Array([0, 0]) };
  expect(colouringOf(frame([0, 1], slower), "speed", range, undefined)).toMatchObject({ least: 0, most: 5 });
  expect(colouringOf(frame([0, 1], columns), "species", range, undefined)).toMatchObject({ by: "kinds" });
  expect(colouringOf(frame([0, 1], columns), "nonsense", range, undefined)).toEqual({ by: "plain" });
});

test("Agents without a size point where they go", () => {
  const drawn = toDrawn(frame([0], { x: new Float64Array([0.5]), y: new Float64Array([0.25]), velocity_x: new Float64Array([0]), velocity_y: new Float64Array([2]) }));
  expect([...(drawn.positions as Float32Array)]).toEqual([0.5, 0.25]);
  expect((drawn.heading as Float32Array)[0]).toBeCloseTo(Math.PI / 2);
  expect(drawn.radius).toBeUndefined();
});

test("series.csv becomes quantities against time, with gaps where nothing was measured", () => {
  const table = readSeries("step,time,speed\n0,0.0,nan\n10,0.5,2.5\n20,1,\n", new Map([["speed", "length/time"]]));
  expect(table.times).toEqual([0, 0.5, 1]);
  expect(table.quantities).toEqual([{ name: "speed", unit: "length/time", values: [NaN, 2.5, NaN] }]);
});
