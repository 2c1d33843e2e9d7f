import type { Box, Point } from "./frame.ts";

/** Which part of the box is seen: box coordinates grow to the right and up, pixels to the right and down. */
export class Camera {
  /** Pixels per unit of length. */
  scale = 1;
  private centre: Point = { x: 0, y: 0 };
  private middle: Point = { x: 0, y: 0 };
  private fitted = 1;

  get isFitted(): boolean {
    return this.scale <= this.fitted * 1.0001;
  }

  /** Shows the whole box in the middle of the given area, and keeps how far the user has zoomed in unless `reset`. */
  fit(box: Box, width: number, height: number, margin: { x: number; top: number; bottom: number }, reset: boolean): void {
    const room = { x: Math.max(1, width - 2 * margin.x), y: Math.max(1, height - margin.top - margin.bottom) };
    const zoom = reset ? 1 : this.scale / this.fitted;
    this.fitted = Math.min(room.x / box.width, room.y / box.height);
    this.scale = this.fitted * zoom;
    this.middle = { x: width / 2, y: margin.top + room.y / 2 };
    if (reset) this.centre = { x: box.width / 2, y: box.height / 2 };
  }

  toPixels(place: Point): Point {
    return {
      x: this.middle.x + (place.x - this.centre.x) * this.scale,
      y: this.middle.y - (place.y - this.centre.y) * this.scale,
    };
  }

  toBox(pixel: Point): Point {
    return {
      x: this.centre.x + (pixel.x - this.middle.x) / this.scale,
      y: this.centre.y - (pixel.y - this.middle.y) / this.scale,
    };
  }

  /** Zooms by a factor, such that the place under the pixel stays there. */
  zoomAt(pixel: Point, factor: number, box: Box): void {
    const under = this.toBox(pixel);
    this.scale = Math.min(Math.max(this.scale * factor, this.fitted), this.fitted * 1000);
    const now = this.toBox(pixel);
    this.centre = { x: this.centre.x + under.x - now.x, y: this.centre.y + under.y - now.y };
    this.keepInside(box);
  }

  /** Moves the picture by pixels. */
  pan(dx: number, dy: number, box: Box): void {
    this.centre = { x: this.centre.x - dx / this.scale, y: this.centre.y + dy / this.scale };
    this.keepInside(box);
  }

  private keepInside(box: Box): void {
    const share = this.fitted / this.scale; // 1 where all is seen: no room to move
    const along = (value: number, side: number): number => {
      const room = Math.max(0, (side / 2) * (1 - share));
      return Math.min(Math.max(value, side / 2 - room), side / 2 + room);
    };
    this.centre = { x: along(this.centre.x, box.width), y: along(this.centre.y, box.height) };
  }
}
