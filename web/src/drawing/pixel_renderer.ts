import type { AgentRenderer } from "./agent_renderer.ts";
import type { Camera } from "./camera.ts";
import type { Paint } from "./colouring.ts";
import type { Frame } from "./frame.ts";
import { outlineWidth, PackedAgents, type Clip } from "./packed_agents.ts";
import type { Colour } from "./palettes.ts";

/** A colour as one number: alpha, blue, green, red from the highest byte to the lowest, as canvases store it. */
function packed(colour: Colour): number {
  const [red, green, blue] = colour.map((part) => Math.round(255 * part)) as [number, number, number];
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}

/** Between two opaque colours, the second with a weight from 0 to 256; red and blue at once, as they leave each other room. */
function mix(from: number, to: number, weight: number): number {
  const rest = 256 - weight;
  const redAndBlue = (((from & 0xff00ff) * rest + (to & 0xff00ff) * weight) >>> 8) & 0xff00ff;
  const green = (((from & 0xff00) * rest + (to & 0xff00) * weight) >>> 8) & 0xff00;
  return (0xff000000 | redAndBlue | green) >>> 0;
}

/** A colour that covers a share of a pixel, from 0 to 1, over what is there already. */
function over(below: number, colour: number, cover: number): number {
  if (below === 0) return ((colour & 0xffffff) | ((255 * cover) << 24)) >>> 0;
  const alphaBelow = below >>> 24;
  if (alphaBelow === 255) return mix(below, colour, (256 * cover) | 0);
  const alpha = 255 * cover + alphaBelow * (1 - cover);
  return ((mix(below, colour, ((65280 * cover) / alpha) | 0) & 0xffffff) | (alpha << 24)) >>> 0;
}

/** Draws by loops over pixels, where there is no graphics processor. The pictures are those of GraphicsRenderer. */
export class PixelRenderer implements AgentRenderer {
  private readonly agents = new PackedAgents();
  private palette: Uint32Array = new Uint32Array(0);
  private image: ImageData | undefined;
  private pixels = new Uint32Array(0);
  private width = 0;
  private clip: Clip = { left: 0, top: 0, right: 0, bottom: 0 };
  private ink = 0;
  private outline = 0;

  constructor(private readonly context: CanvasRenderingContext2D) {}

  load(frame: Frame, paint: Paint): void {
    this.agents.pack(frame, paint);
    this.palette = Uint32Array.from(paint.palette, packed);
  }

  draw(camera: Camera, pixelRatio: number, ink: Colour): void {
    this.begin(camera, pixelRatio, ink);
    const { numbers, count, mark } = this.agents;
    const scale = camera.scale * pixelRatio;
    const origin = camera.toPixels({ x: 0, y: 0 });
    for (let i = 0; i < count; ++i) {
      const x = origin.x * pixelRatio + (numbers[4 * i] as number) * scale;
      const y = origin.y * pixelRatio - (numbers[4 * i + 1] as number) * scale;
      const third = numbers[4 * i + 2] as number;
      const colour = this.palette[numbers[4 * i + 3] as number] as number;
      if (mark > 0) this.drawDart(x, y, Math.max(0.7, mark * scale), third, colour);
      else this.drawDisk(x, y, third * scale, colour);
    }
    this.context.putImageData(this.image as ImageData, 0, 0);
  }

  finish(): void {
    this.context.getImageData(0, 0, 1, 1);
  }

  dispose(): void {
    this.image = undefined;
  }

  private begin(camera: Camera, pixelRatio: number, ink: Colour): void {
    const { width, height } = this.context.canvas;
    if (this.image === undefined || this.image.width !== width || this.image.height !== height) {
      this.image = new ImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    } else {
      this.pixels.fill(0);
    }
    this.width = width;
    const clip = this.agents.clip(camera, pixelRatio) ?? { left: 0, top: 0, right: width, bottom: height };
    this.clip = {
      left: Math.max(0, clip.left),
      top: Math.max(0, clip.top),
      right: Math.min(width, clip.right),
      bottom: Math.min(height, clip.bottom),
    };
    this.ink = packed(ink);
    this.outline = outlineWidth(this.agents.smallest * camera.scale * pixelRatio, pixelRatio);
  }

  private drawDisk(x: number, y: number, size: number, colour: number): void {
    const radius = Math.max(0.7, size);
    const strength = size < 0.7 ? (size * size) / 0.49 : 1; // a disk below a pixel covers less of it
    const { clip, pixels, width } = this;
    const outer = radius + 0.5;
    const solid = strength === 1 ? Math.max(0, radius - this.outline - 0.5) : 0;
    const bottom = Math.min(clip.bottom, Math.ceil(y + outer));
    for (let row = Math.max(clip.top, Math.floor(y - outer)); row < bottom; ++row) {
      const dy = row + 0.5 - y;
      const half = outer * outer - dy * dy;
      if (half <= 0) continue;
      const reach = Math.sqrt(half);
      const left = Math.max(clip.left, Math.floor(x - reach));
      const right = Math.min(clip.right, Math.ceil(x + reach));
      const inside = solid * solid - dy * dy;
      const core = inside > 0 ? Math.sqrt(inside) : 0;
      const from = core > 0 ? Math.max(left, Math.ceil(x - core - 0.5)) : right;
      const to = core > 0 ? Math.min(right, Math.floor(x + core + 0.5)) : right;
      const start = row * width;
      for (let column = left; column < right; ++column) {
        if (column === from && to > from) {
          pixels.fill(colour, start + from, start + to);
          column = to;
          if (column >= right) break;
        }
        const dx = column + 0.5 - x;
        this.put(start + column, radius - Math.sqrt(dx * dx + dy * dy), strength, colour);
      }
    }
  }

  private drawDart(x: number, y: number, radius: number, heading: number, colour: number): void {
    const { clip, width } = this;
    const cosine = Math.cos(heading);
    const sine = -Math.sin(heading); // pixels grow downwards
    const around = 1.8 * radius + 1;
    const right = Math.min(clip.right, Math.ceil(x + around));
    const bottom = Math.min(clip.bottom, Math.ceil(y + around));
    for (let row = Math.max(clip.top, Math.floor(y - around)); row < bottom; ++row) {
      for (let column = Math.max(clip.left, Math.floor(x - around)); column < right; ++column) {
        const dx = column + 0.5 - x;
        const dy = row + 0.5 - y;
        const ahead = dx * cosine + dy * sine;
        const beside = Math.abs(dx * sine - dy * cosine);
        const side = (1.7 * radius - ahead) * 0.316 - beside * 0.949;
        this.put(row * width + column, Math.min(side, ahead + 1.2 * radius), 1, colour);
      }
    }
  }

  /** One pixel at a depth inside an agent; as the shader has it. */
  private put(at: number, depth: number, strength: number, colour: number): void {
    if (depth <= -0.5) return;
    const cover = (depth < 0.5 ? depth + 0.5 : 1) * strength;
    const inside = this.outline > 0 ? Math.min(Math.max(depth - this.outline + 0.5, 0), 1) : 1;
    const shown = inside === 1 ? colour : mix(this.ink, colour, (256 * inside) | 0);
    this.pixels[at] = cover === 1 ? shown : over(this.pixels[at] as number, shown, cover);
  }
}
