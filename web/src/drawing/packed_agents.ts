import type { Camera } from "./camera.ts";
import type { Paint } from "./colouring.ts";
import { imagesInSight, markRadius, periodicAxes, withoutBigInts, type Box, type Frame, type Numbers } from "./frame.ts";

/** A rectangle in pixels of a canvas, from its upper left corner. */
export interface Clip {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/** The agents of a frame as renderers need them: four numbers each, and in a periodic box the images of those across an edge too. */
export class PackedAgents {
  /** Of each agent x, y, the radius or of a dart the heading, and the place in the palette. */
  numbers = new Float32Array(0);
  count = 0;
  /** The radius of darts; 0 where agents are disks. */
  mark = 0;
  /** The smallest radius. */
  smallest = 0;
  private box: Box | undefined;
  private rowLength = 1;

  /** `rowLength`: the numbers have room for whole rows of so many agents. */
  pack(frame: Frame, paint: Paint, rowLength = 1): void {
    this.rowLength = rowLength;
    const { positions, radius, heading, box, count } = frame;
    this.reserve(count);
    this.box = box;
    const mark = markRadius(box, count);
    this.mark = radius === undefined && heading !== undefined ? mark : 0;
    const oneRadius = radius === undefined ? mark : typeof radius === "number" ? radius : 0;
    const radii = typeof radius === "object" ? withoutBigInts(radius) : undefined;
    const thirds = this.mark > 0 ? withoutBigInts(heading as Numbers) : radii;
    const points = withoutBigInts(positions);
    const { numbers } = this;
    const { places } = paint;
    let smallest = oneRadius > 0 && count > 0 ? oneRadius : Infinity;
    for (let i = 0; i < count; ++i) {
      numbers[4 * i] = points[2 * i] as number;
      numbers[4 * i + 1] = points[2 * i + 1] as number;
      numbers[4 * i + 2] = oneRadius;
      numbers[4 * i + 3] = places[i] as number;
    }
    if (thirds !== undefined) for (let i = 0; i < count; ++i) numbers[4 * i + 2] = thirds[i] as number;
    for (const r of radii?.subarray(0, count) ?? []) if (r < smallest && r > 0) smallest = r;
    this.smallest = smallest < Infinity ? smallest : 0;
    this.count = periodicAxes(box).some(Boolean) ? this.addImages(box, count, this.mark > 0 ? 2.2 * mark : undefined) : count;
  }

  /** Images of the agents that reach across an edge of a periodic box. */
  private addImages(box: Box, count: number, reach: number | undefined): number {
    const [isPeriodicX, isPeriodicY] = periodicAxes(box);
    let end = count;
    for (let i = 0; i < count; ++i) {
      const x = this.numbers[4 * i] as number;
      const y = this.numbers[4 * i + 1] as number;
      const third = this.numbers[4 * i + 2] as number;
      const r = reach ?? third;
      const isInside = !((isPeriodicX && (x < r || x > box.width - r)) || (isPeriodicY && (y < r || y > box.height - r)));
      if (isInside) continue;
      this.reserve(end + 3);
      const place = this.numbers[4 * i + 3] as number;
      const [, ...images] = imagesInSight(box, x, y, r);
      for (const image of images) end = this.put(end, image.x, image.y, third, place);
    }
    return end;
  }

  private put(at: number, x: number, y: number, third: number, place: number): number {
    const packed = this.numbers;
    packed[4 * at] = x;
    packed[4 * at + 1] = y;
    packed[4 * at + 2] = third;
    packed[4 * at + 3] = place;
    return at + 1;
  }

  private reserve(agents: number): void {
    const numbers = 4 * this.rowLength * Math.ceil(Math.max(1, agents) / this.rowLength);
    if (numbers <= this.numbers.length) return;
    // A quarter more, so that a few images of disks do not move all numbers again and again.
    const larger = new Float32Array(4 * this.rowLength * Math.ceil((numbers / 4 / this.rowLength) * 1.25));
    larger.set(this.numbers);
    this.numbers = larger;
  }

  /** The box where it is periodic: images of disks end at its edges. */
  clip(camera: Camera, pixelRatio: number): Clip | undefined {
    if (this.box === undefined || !periodicAxes(this.box).some(Boolean)) return undefined;
    const least = camera.toPixels({ x: 0, y: 0 });
    const most = camera.toPixels({ x: this.box.width, y: this.box.height });
    const round = (pixels: number): number => Math.round(Math.min(Math.max(pixels * pixelRatio, -1e6), 1e6));
    return { left: round(least.x), top: round(most.y), right: round(most.x), bottom: round(least.y) };
  }
}

/** Pixels of the line around disks: thin against the disk, and none where it would be all there is to see. */
export function outlineWidth(smallest: number, pixelRatio: number): number {
  return smallest < 2.5 * pixelRatio ? 0 : Math.min(0.9 * pixelRatio, 0.12 * smallest);
}
