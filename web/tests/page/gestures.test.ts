import { describe, expect, test } from "vitest";

import type { Point } from "../../src/drawing/frame.ts";
import { Gestures } from "../../src/drawing/gestures.ts";

/** What the gestures of an element of 200 × 100 pixels, from (10, 20) on, do to its picture. */
class Picture {
  readonly done: unknown[][] = [];
  private readonly listeners = new Map<string, (event: never) => void>();

  constructor(isMeasuring = false) {
    const element = {
      addEventListener: (name: string, listener: (event: never) => void) => this.listeners.set(name, listener),
      getBoundingClientRect: () => ({ left: 10, top: 20 }),
      setPointerCapture: () => {},
    };
    const note = (name: string) => (...given: unknown[]): void => void this.done.push([name, ...given]);
    new Gestures(element as never, {
      isMeasuring: () => isMeasuring,
      pan: note("pan"),
      zoom: note("zoom"),
      reset: note("reset"),
      click: note("click"),
      measure: note("measure"),
      middle: (): Point => ({ x: 100, y: 50 }),
    });
  }

  send(name: string, event: object): void {
    this.listeners.get(name)?.({ pointerId: 1, button: 0, preventDefault: () => {}, stopPropagation: () => {}, ...event } as never);
  }
}

describe("gestures", () => {
  test("an arrow shows more of the side that it points to: the picture moves the other way", () => {
    for (const [key, dx, dy] of [["ArrowLeft", 40, 0], ["ArrowRight", -40, 0], ["ArrowUp", 0, 40], ["ArrowDown", 0, -40]] as const) {
      const picture = new Picture();
      picture.send("keydown", { key });
      expect(picture.done).toEqual([["pan", dx, dy]]);
    }
  });

  test("dragging moves the picture by what the pointer has moved, and a press that stays is a click", () => {
    const picture = new Picture();
    picture.send("pointerdown", { clientX: 30, clientY: 50 });
    picture.send("pointermove", { clientX: 45, clientY: 40 });
    picture.send("pointerup", { clientX: 45, clientY: 40 });
    expect(picture.done).toEqual([["pan", 15, -10]]);
    const clicked = new Picture();
    clicked.send("pointerdown", { clientX: 30, clientY: 50 });
    clicked.send("pointerup", { clientX: 32, clientY: 51 });
    expect(clicked.done).toEqual([["click", { x: 22, y: 31 }]]);
  });

  test("where distances are measured, dragging goes from the press to the pointer", () => {
    const picture = new Picture(true);
    picture.send("pointerdown", { clientX: 30, clientY: 50 });
    picture.send("pointermove", { clientX: 90, clientY: 70 });
    expect(picture.done).toEqual([["measure", { x: 20, y: 30 }, { x: 80, y: 50 }]]);
  });

  test("two fingers that part zoom in about their middle", () => {
    const picture = new Picture();
    picture.send("pointerdown", { pointerId: 1, clientX: 30, clientY: 50 });
    picture.send("pointerdown", { pointerId: 2, clientX: 50, clientY: 50 });
    picture.send("pointermove", { pointerId: 2, clientX: 70, clientY: 50 });
    expect(picture.done).toEqual([["zoom", { x: 40, y: 30 }, 2]]);
  });
});
