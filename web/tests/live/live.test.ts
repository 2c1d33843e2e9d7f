/** What comes from a program that shows a model, and how it is drawn. */

import { describe, expect, test } from "vitest";

import { chartsFor } from "../../src/charts/run_charts.ts";
import { pixelsOf, shadesOn } from "../../src/drawing/field_layer.ts";
import { DARK, LIGHT } from "../../src/drawing/overlay.ts";
import { readLiveFrame } from "../../src/live/live_model.ts";

describe("a field", () => {
  const field = { columns: 2, rows: 2, values: Float32Array.from([0, 1, 2, NaN]), least: 0, most: 2 };

  test("has its lower row at the bottom, the ground where it is least, and no colour of its own where it is no number", () => {
    const shades = shadesOn(LIGHT);
    const pixels = pixelsOf(field, shades);
    const at = (pixel: number): number[] => [...pixels.subarray(4 * pixel, 4 * pixel + 4)];
    const strongest = [...shades.subarray(4 * 255)];
    expect([at(0), at(1), at(2)]).toEqual([strongest, [255, 255, 255, 255], [255, 255, 255, 255]]);
    expect(at(3)).toEqual([...shades.subarray(4 * 128, 4 * 129)]);
  });

  test("begins at the ground of either theme and becomes darker on a light one, lighter on a dark one", () => {
    for (const theme of [LIGHT, DARK]) {
      const shades = shadesOn(theme);
      expect([...shades.subarray(0, 3)]).toEqual(theme.background.map((part) => Math.round(255 * part)));
      const sums = Array.from({ length: 256 }, (_, i) => [0, 1, 2].reduce((sum, part) => sum + (shades[4 * i + part] as number), 0));
      for (let i = 32; i < 256; i += 32) expect(((sums[i] as number) - (sums[i - 32] as number)) * (theme === LIGHT ? -1 : 1)).toBeGreaterThan(0);
    }
  });
});

describe("charts", () => {
  test("that a model declares come first, with their curves in its order, and take their quantities out of the others", () => {
    const columns = ["susceptible", "infected", "recovered", "speed"].map((name) => ({ name, unit: "", documentation: "" }));
    const charts = chartsFor(columns, [{ title: "People", names: ["recovered", "infected"] }, { title: "speed", names: ["speed"] }]);
    expect(charts.map(({ title, curves }) => [title, curves.map(({ name }) => name)])).toEqual([
      ["People", ["recovered", "infected"]], ["Speed", ["speed"]], ["Susceptible", ["susceptible"]],
    ]);
  });
});

test("a frame is read with its columns of four bytes, its fields and its rows of the series", () => {
  const head = {
    run: 2, changes: 4, version: 9, step: 3, time: 0.5, count: 2, box: { width: 1, height: 1, periodic: [true, false], shift: 0 }, stateHash: "", isRunning: true,
    speed: null, stepsPerSecond: 7, problem: "", columns: [{ name: "id", type: "uint32", offset: 0 }, { name: "x", type: "float32", offset: 8 }],
    fields: [{ name: "grass", rows: 1, columns: 2, offset: 16 }], series: { rows: 5, kept: 1, width: 2, offset: 24 },
  };
  const text = new TextEncoder().encode(JSON.stringify(head));
  const length = text.length + ((8 - ((4 + text.length) % 8)) % 8);
  const bytes = new Uint8Array(4 + length + 40).fill(32);
  new DataView(bytes.buffer).setUint32(0, length, true);
  bytes.set(text, 4);
  new Uint32Array(bytes.buffer, 4 + length, 2).set([4, 7]);
  new Float32Array(bytes.buffer, 4 + length + 8, 4).set([0.25, 0.5, 1, 2]);
  new Float64Array(bytes.buffer, 4 + length + 24, 2).set([3, 0.5]);
  const frame = readLiveFrame(bytes.buffer);
  expect([...frame.ids]).toEqual([4, 7]);
  expect([...(frame.columns["x"] as Float32Array)]).toEqual([0.25, 0.5]);
  expect(Object.entries(frame.fields).map(([name, { values }]) => [name, ...values])).toEqual([["grass", 1, 2]]);
  expect([[...frame.series], frame.newRows, frame.run, frame.changes, frame.version, frame.speed]).toEqual([[3, 0.5], 5, 2, 4, 9, null]);
});
