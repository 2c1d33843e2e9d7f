import type { Camera } from "./camera.ts";
import type { Paint } from "./colouring.ts";
import type { Frame } from "./frame.ts";
import { GraphicsRenderer } from "./graphics_renderer.ts";
import { PixelRenderer } from "./pixel_renderer.ts";
import type { Colour } from "./palettes.ts";

/** Draws the disks, or darts, of one frame on a canvas. */
export interface AgentRenderer {
  /** Takes over a frame and its colours; in a periodic box the images of disks that reach across an edge too. */
  load(frame: Frame, paint: Paint): void;
  /** Draws what was loaded, on nothing. `pixelRatio` is that of the canvas to the pixels of the camera. */
  draw(camera: Camera, pixelRatio: number, ink: Colour): void;
  /** Waits until what was drawn is there. For measurements: it stops the browser from working ahead. */
  finish(): void;
  dispose(): void;
}

export type RendererKind = "automatic" | "webgl" | "pixels";

/**
 * The graphics processor by WebGL 2, or where there is none, on remote desktops and in virtual machines, this processor: its own
 * loops over pixels draw 1e5 disks several times faster than WebGL in software.
 */
export function makeRenderer(canvas: HTMLCanvasElement, kind: RendererKind): AgentRenderer {
  const options = { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true };
  const gl =
    kind === "pixels" ? null : canvas.getContext("webgl2", { ...options, failIfMajorPerformanceCaveat: kind === "automatic" });
  if (gl !== null) return new GraphicsRenderer(gl);
  if (kind === "webgl") throw new Error("this browser has no WebGL 2; open the page without ?renderer=webgl");
  const context = canvas.getContext("2d");
  if (context === null) throw new Error("this browser draws on no canvas; use a current browser");
  return new PixelRenderer(context);
}
