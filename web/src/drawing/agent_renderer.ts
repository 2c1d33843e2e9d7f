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

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether WebGL 2 is there and drawn by a graphics processor, not by a program that imitates one. */
function hasGraphicsProcessor(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  if (gl === null) return false;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(names === null ? gl.RENDERER : names.UNMASKED_RENDERER_WEBGL));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return !SOFTWARE.test(name);
}

let isAccelerated: boolean | undefined;

/**
 * The graphics processor by WebGL 2, or where there is none, on remote desktops and in virtual machines, this processor: its own
 * loops over pixels draw 1e5 disks several times faster than WebGL in software.
 */
export function makeRenderer(canvas: HTMLCanvasElement, kind: RendererKind): AgentRenderer {
  isAccelerated ??= kind === "automatic" ? hasGraphicsProcessor() : undefined;
  if (kind === "webgl" || (kind === "automatic" && isAccelerated === true)) {
    const gl = canvas.getContext("webgl2", { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true });
    if (gl !== null) return new GraphicsRenderer(gl);
    throw new Error("this browser has no WebGL 2; open the page with ?renderer=pixels");
  }
  const context = canvas.getContext("2d", { willReadFrequently: true }); // kept by this processor, which draws it
  if (context === null) throw new Error("this browser draws on no canvas; use a current browser");
  return new PixelRenderer(context);
}
