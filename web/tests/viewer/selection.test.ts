import { expect, test } from "vitest";

import { toggled } from "../../src/viewer/selection.ts";

test("of seven selected agents the first is dropped, and the seventh is there", () => {
  const clicks = [40, 7, 19, 3, 88, 21, 5];
  const selected = clicks.reduce<number[]>((ids, id) => toggled(ids, id), []);
  expect(selected).toEqual([7, 19, 3, 88, 21, 5]);
});

test("a second click takes an agent out, and no other", () => {
  expect(toggled([40, 7, 19], 7)).toEqual([40, 19]);
  expect(toggled([40, 7, 19, 3, 88, 21], 21)).toEqual([40, 7, 19, 3, 88]);
});
