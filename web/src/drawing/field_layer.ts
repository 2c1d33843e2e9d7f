import type { Camera } from "./camera.ts";
import { withoutBigInts, type Box, type DrawnField, type Field, type FieldRange, type Frame } from "./frame.ts";
import type { Theme } from "./overlay.ts";
import { mixed, type Colour } from "./palettes.ts";

const SHADES = 256;
const LIGHT_GREEN: Colour = [0.68, 0.87, 0.56];
const DARK_GREEN: Colour = [0, 0.41, 0.22];

/** Colours of a field, from that of the ground to a strong green: those of movies. Four bytes each, as pixels have them. */
export function shadesOn({ background }: Pick<Theme, "background">): Uint8ClampedArray {
  const isDark = background[0] < 0.5;
  const [middle, end] = isDark ? [DARK_GREEN, LIGHT_GREEN] : [LIGHT_GREEN, DARK_GREEN];
  const bytes = new Uint8ClampedArray(4 * SHADES);
  for (let i = 0; i < SHADES; ++i) {
    const share = (2 * i) / (SHADES - 1);
    const colour = share < 1 ? mixed(background, middle, share) : mixed(middle, end, share - 1);
    bytes.set([...colour.map((part) => 255 * part), 255], 4 * i);
  }
  return bytes;
}

/** From 0 or the least value, where one is negative, to the largest, of a field and of those before it. */
export function rangeOfField({ values }: Field, before: FieldRange = { least: 0, most: -Infinity }): FieldRange {
  let { least, most } = before;
  for (const value of withoutBigInts(values)) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return { least, most };
}

/** The pixels of a field, a cell each, from its upper row to its lower one. */
export function pixelsOf({ columns, rows, values, least, most }: DrawnField, shades: Uint8ClampedArray): Uint8ClampedArray<ArrayBuffer> {
  const pixels = new Uint8ClampedArray(4 * columns * rows);
  const numbers = withoutBigInts(values);
  const per = (SHADES - 1) / (most > least ? most - least : 1);
  for (let row = 0; row < rows; ++row) {
    let at = 4 * columns * (rows - 1 - row);
    for (let cell = columns * row; cell < columns * (row + 1); ++cell, at += 4) {
      const shade = Math.round(Math.min(Math.max(((numbers[cell] as number) - least) * per, 0), SHADES - 1)) || 0;
      for (let part = 0; part < 4; ++part) pixels[at + part] = shades[4 * shade + part] as number;
    }
  }
  return pixels;
}

/** The cells of a field beneath the agents, on a canvas that is there as soon as there is a field. */
export class FieldLayer {
  private readonly canvas = document.createElement("canvas");
  private readonly cells = document.createElement("canvas");
  private box: Box | undefined;

  /** Takes over the field of a frame; `above` is the canvas of the agents. */
  load({ box, field }: Frame, theme: Theme, above: HTMLCanvasElement): void {
    this.box = field === undefined ? undefined : box;
    this.canvas.hidden = field === undefined;
    if (field === undefined) return;
    if (!this.canvas.isConnected) {
      this.canvas.style.cssText = above.style.cssText;
      above.before(this.canvas);
    }
    this.cells.width = field.columns;
    this.cells.height = field.rows;
    const image = new ImageData(pixelsOf(field, shadesOn(theme)), field.columns, field.rows);
    (this.cells.getContext("2d") as CanvasRenderingContext2D).putImageData(image, 0, 0);
  }

  /** Draws what was loaded, as large as the canvas of the agents. */
  draw(camera: Camera, pixelRatio: number, { width, height }: HTMLCanvasElement): void {
    if (this.box === undefined) return;
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    const context = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    context.clearRect(0, 0, width, height);
    const corner = camera.toPixels({ x: 0, y: this.box.height });
    const scale = camera.scale * pixelRatio;
    context.imageSmoothingEnabled = false;
    context.drawImage(this.cells, corner.x * pixelRatio, corner.y * pixelRatio, this.box.width * scale, this.box.height * scale);
  }

  /** Draws it on another canvas of that size. */
  drawOn(context: CanvasRenderingContext2D): void {
    if (this.box !== undefined) context.drawImage(this.canvas, 0, 0);
  }

  /** The cells as a picture in a text; undefined where there is no field. */
  get href(): string | undefined {
    return this.box === undefined ? undefined : this.cells.toDataURL("image/png");
  }

  dispose(): void {
    this.canvas.remove();
  }
}
