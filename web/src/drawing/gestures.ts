import type { Point } from "./frame.ts";

/** What gestures do to a picture; places are pixels from its upper left corner. */
export interface GestureTarget {
  isMeasuring(): boolean;
  pan(dx: number, dy: number): void;
  zoom(at: Point, factor: number): void;
  reset(): void;
  click(at: Point): void;
  measure(from: Point, to: Point): void;
  middle(): Point;
}

const CLICK_PIXELS = 5; // a press that moves less is a click
const KEY_PIXELS = 40;

/** Mouse, touch, pen, wheel and keys on an element, translated to a GestureTarget. */
export class Gestures {
  private readonly pressed = new Map<number, Point>();
  private start: Point = { x: 0, y: 0 };
  private hasMoved = false;

  constructor(
    private readonly element: HTMLElement,
    private readonly target: GestureTarget,
  ) {
    element.addEventListener("pointerdown", (event) => this.press(event));
    element.addEventListener("pointermove", (event) => this.move(event));
    element.addEventListener("pointerup", (event) => this.release(event));
    element.addEventListener("pointercancel", (event) => this.pressed.delete(event.pointerId));
    element.addEventListener("dblclick", () => target.reset());
    element.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    element.addEventListener("keydown", (event) => this.key(event));
  }

  private place(event: MouseEvent): Point {
    const at = this.element.getBoundingClientRect();
    return { x: event.clientX - at.left, y: event.clientY - at.top };
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.pressed.set(event.pointerId, this.place(event));
    this.element.setPointerCapture(event.pointerId);
    this.start = this.place(event);
    this.hasMoved = this.pressed.size > 1;
  }

  private move(event: PointerEvent): void {
    const before = this.pressed.get(event.pointerId);
    if (before === undefined) return;
    const now = this.place(event);
    if (this.pressed.size === 2) this.pinch(event.pointerId, before, now);
    this.pressed.set(event.pointerId, now);
    if (Math.hypot(now.x - this.start.x, now.y - this.start.y) > CLICK_PIXELS) this.hasMoved = true;
    if (!this.hasMoved || this.pressed.size > 1) return;
    if (this.target.isMeasuring()) this.target.measure(this.start, now);
    else this.target.pan(now.x - before.x, now.y - before.y);
  }

  private pinch(moved: number, before: Point, now: Point): void {
    for (const [id, other] of this.pressed) {
      if (id === moved) continue;
      const apart = Math.hypot(before.x - other.x, before.y - other.y);
      const apartNow = Math.hypot(now.x - other.x, now.y - other.y);
      if (apart > 0) this.target.zoom({ x: (now.x + other.x) / 2, y: (now.y + other.y) / 2 }, apartNow / apart);
    }
  }

  private release(event: PointerEvent): void {
    if (!this.pressed.delete(event.pointerId) || this.hasMoved || this.pressed.size > 0) return;
    if (!this.target.isMeasuring()) this.target.click(this.place(event));
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 * event.deltaY : event.deltaY;
    this.target.zoom(this.place(event), Math.exp(-pixels / 400));
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const pan: Record<string, [number, number]> = {
      ArrowLeft: [KEY_PIXELS, 0],
      ArrowRight: [-KEY_PIXELS, 0],
      ArrowUp: [0, KEY_PIXELS],
      ArrowDown: [0, -KEY_PIXELS],
    };
    const by = pan[event.key];
    if (by !== undefined) this.target.pan(...by);
    else if (event.key === "+" || event.key === "=") this.target.zoom(this.target.middle(), 1.25);
    else if (event.key === "-") this.target.zoom(this.target.middle(), 0.8);
    else if (event.key === "0") this.target.reset();
    else if (event.key === "Enter") this.target.click(this.target.middle());
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
