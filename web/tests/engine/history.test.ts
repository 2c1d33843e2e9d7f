import { expect, test } from "vitest";

import type { Session } from "../../src/engine/gridlock.ts";
import { History } from "../../src/engine/history.ts";

/** A run at a step, whose state is the step alone. */
const at = (step: number, bytes = 1): Session => ({ step, isPrepared: true, save: () => new Uint8Array(bytes).fill(step) }) as never;
const stepOf = (state: Uint8Array): number => state[0] as number;

test("a history goes back to the latest state that is not behind the step, and to the start before all", () => {
  const history = new History();
  for (const step of [3, 10, 20]) history.keep(at(step));
  for (const [step, kept] of [[0, 3], [3, 3], [9, 3], [10, 10], [19, 10], [20, 20], [99, 20]] as const) {
    expect(stepOf(history.before(step)), `step ${step}`).toBe(kept);
  }
});

test("a run that goes on from an earlier step forgets the later states, and never the start", () => {
  const history = new History();
  for (const step of [3, 10, 20]) history.keep(at(step));
  history.forgetAfter(at(10));
  expect(stepOf(history.before(99))).toBe(10);
  history.forgetAfter(at(1));
  expect(stepOf(history.before(99))).toBe(3);
});

test("of more than 64 states every second one is let go of, the start never", () => {
  const history = new History();
  history.keep(at(0));
  for (let step = 1; step <= 64; ++step) history.keepAnother(at(step));
  expect(stepOf(history.first())).toBe(0);
  expect([63, 64].map((step) => stepOf(history.before(step)))).toEqual([62, 64]);
});
