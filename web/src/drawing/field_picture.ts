/** A field, numbers on a grid over the box, which is drawn beneath the agents. */

import type { Camera } from "./camera.ts";
import { withoutBigInts, type Box, type Numbers } from "./frame.ts";
import { mixed, UNKNOWN_VALUE, WHITE, type Colour } from "./palettes.ts";

export interface Field {
  readonly columns: number;
  readonly rows: number;
  /** Row by row from the bottom of the box. */
  readonly values: Numbers;
}

/** The numbers that are white and dark green. */
export interface FieldRange {
  readonly least: number;
  readonly most: number;
}

const LIGHT_GREEN: Colour = [0.68, 0.87, 0.56];
const DARK_GREEN: Colour = [0, 0.41, 0.22];

/** From 0 or the least value, where one is negative, to the largest, of a field and of those before it. */
export function rangeOfField({ values }: Field, before: FieldRange = { least: 0, most: -Infinity }): FieldRange {
  let { least, most } = before;
  for (const value of withoutBigInts(values)) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return { least, most };
}

/** Red, green, blue and opacity of each cell, in bytes; the top row first, as pictures have them. */
export function pixelsOfField({ columns, rows, values }: Field, { least, most }: FieldRange): Uint8ClampedArray<ArrayBuffer> {
  const pixels = new Uint8ClampedArray(4 * columns * rows);
  const scale = most > least ? 2 / (most - least) : 0;
  const numbers = withoutBigInts(values);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const share = ((numbers[row * columns + column] as number) - least) * scale;
      const colour = Number.isNaN(share) ? UNKNOWN_VALUE : share < 1 ? mixed(WHITE, LIGHT_GREEN, share) : mixed(LIGHT_GREEN, DARK_GREEN, share - 1);
      pixels.set([255 * colour[0], 255 * colour[1], 255 * colour[2], 255], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  return pixels;
}

/** The picture of a field on a canvas of its own beneath those of the agents, which is there from the first field on. */
export class FieldPicture {
  readonly canvas = document.createElement("canvas");
  private readonly cells = document.createElement("canvas");

  load(field: Field, range: FieldRange): void {
    [this.cells.width, this.cells.height] = [field.columns, field.rows];
    const context = this.cells.getContext("2d") as CanvasRenderingContext2D;
    context.putImageData(new ImageData(pixelsOfField(field, range), field.columns, field.rows), 0, 0);
  }

  draw(camera: Camera, box: Box, pixelRatio: number, width: number, height: number): void {
    [this.canvas.width, this.canvas.height] = [width, height];
    const context = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    const corner = camera.toPixels({ x: 0, y: box.height });
    context.setTransform(pixelRatio, 0, 0, pixelRatio, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.cells, corner.x, corner.y, box.width * camera.scale, box.height * camera.scale);
  }

  /** The cells as an address that an SVG file can hold. */
  address(): string {
    return this.cells.toDataURL("image/png");
  }
}
