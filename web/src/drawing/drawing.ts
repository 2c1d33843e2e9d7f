import { makeRenderer, type AgentRenderer, type RendererKind } from "./agent_renderer.ts";
import { Camera } from "./camera.ts";
import { paint, type Colouring, type Paint } from "./colouring.ts";
import { download, Recording } from "./export.ts";
import { FieldLayer } from "./field_layer.ts";
import { numberAt, type Frame, type Point } from "./frame.ts";
import { Gestures } from "./gestures.ts";
import { drawOverlay, LEGEND_HEIGHT, LIGHT, shortNumber, type Overlay, type Theme } from "./overlay.ts";
import { agentAt, distance } from "./picking.ts";
import { toSvg } from "./svg.ts";

/** "?renderer=webgl" or "pixels" at the end of the address decides, for comparisons and for faulty drivers. */
function chosenRenderer(): RendererKind {
  const asked = new URLSearchParams(location.search).get("renderer");
  return asked === "webgl" || asked === "pixels" ? asked : "automatic";
}

export type Tool = "select" | "measure";

/**
 * The picture of a run in an element of the page: agents by WebGL 2 or on this processor, over them the box, the grid, selections and a legend.
 *
 * It serves the playground and the viewer. Give it a frame and what its agents are coloured by; it redraws itself where the
 * element changes its size, and where the user zooms or drags.
 *
 * ```ts
 * const drawing = new Drawing(document.querySelector("#picture")!);
 * drawing.show(
 *   { box: { width: 1, height: 1, periodic: true }, count: 2, positions: new Float32Array([0.2, 0.2, 0.7, 0.7]), radius: 0.1 },
 *   { by: "values", label: "speed", values: new Float32Array([0.1, 0.4]), least: 0, most: 0.4 },
 * );
 * drawing.setOverlay({ grid: { columns: 10, rows: 10 }, selected: [1] });
 * drawing.onPick = (row) => console.log(row === null ? "nobody" : `row ${row}`);
 * await drawing.save("png", "two_disks");
 * ```
 *
 * The frame and the values are read at once and kept until the next show(), for picking and export: do not change their arrays
 * meanwhile. Cost: O(N) a frame, about 1 ms for 1e5 agents on top of what the browser needs to draw them.
 */
export class Drawing {
  /** The row of the agent that was clicked, or null for a click beside all agents. */
  onPick: (row: number | null) => void = () => {};
  /** A distance was measured, in units of length. */
  onMeasure: (length: number) => void = () => {};
  /** What dragging does: "select" moves the picture and picks by a click, "measure" measures from press to release. */
  tool: Tool = "select";
  readonly camera = new Camera();
  private readonly agents = document.createElement("canvas");
  private readonly beneath = new FieldLayer();
  private readonly over = document.createElement("canvas");
  private readonly context: CanvasRenderingContext2D;
  private renderer: AgentRenderer;
  private readonly observer: ResizeObserver;
  private isEmpty = true;
  private frame: Frame = { box: { width: 1, height: 1, periodic: false }, count: 0, positions: new Float32Array(0) };
  private paint: Paint = { palette: [], places: new Uint16Array(0), legend: { kind: "none" } };
  private overlay: Overlay = {};
  private theme: Theme = LIGHT;
  private pixelRatio = 1;
  private scheduled = 0;
  private recording: Recording | undefined;

  /** Fills `host`, which has a size of its own. Throws Error where the browser cannot draw. */
  constructor(
    private readonly host: HTMLElement,
    private readonly kind: RendererKind = chosenRenderer(),
  ) {
    for (const canvas of [this.agents, this.over]) {
      canvas.style.cssText = "position:absolute;inset:0;width:100%;height:100%;display:block";
      host.append(canvas);
    }
    this.over.tabIndex = 0;
    this.over.setAttribute("role", "img");
    this.context = this.over.getContext("2d") as CanvasRenderingContext2D;
    this.renderer = makeRenderer(this.agents, this.kind);
    this.restoreLostContext();
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(host);
    new Gestures(this.over, this.gestureTarget());
    this.resize();
  }

  /** The canvas that has the keyboard's focus: arrows move, + and − zoom, 0 shows all. */
  get element(): HTMLElement {
    return this.over;
  }

  /** Draws a frame. Throws RangeError if there are not as many values as agents. */
  show(frame: Frame, colouring: Colouring): void {
    const painted = paint(frame, colouring);
    const before = this.frame.box;
    const isOther = this.isEmpty || before.width !== frame.box.width || before.height !== frame.box.height;
    const movesUp = (painted.legend.kind === "none") !== (this.paint.legend.kind === "none");
    this.isEmpty = false;
    this.frame = frame;
    this.paint = painted;
    this.renderer.load(frame, painted);
    this.beneath.load(frame, this.theme, this.agents);
    if (isOther || movesUp) this.fit(isOther);
    this.redraw();
  }

  setOverlay(overlay: Overlay): void {
    this.overlay = overlay;
    this.redraw();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.beneath.load(this.frame, theme, this.agents);
    this.redraw();
  }

  /** What a screen reader says of the picture. */
  describe(text: string): void {
    if (this.over.getAttribute("aria-label") !== text) this.over.setAttribute("aria-label", text);
  }

  /** Shows the whole box again. */
  resetView(): void {
    this.fit(true);
    this.redraw();
  }

  /** The view as "png" (twice as sharp as on the screen), or as "svg", which takes up to 200,000 agents. Throws RangeError beyond. */
  async picture(format: "png" | "svg"): Promise<Blob> {
    if (format === "svg") {
      const text = toSvg({
        frame: this.frame,
        paint: this.paint,
        camera: this.camera,
        overlay: this.overlay,
        theme: this.theme,
        width: this.host.clientWidth,
        height: this.host.clientHeight,
        beneath: this.beneath,
      });
      return new Blob([text], { type: "image/svg+xml" });
    }
    this.setSize(2 * this.pixelRatio);
    this.paintNow();
    const blob = await new Promise<Blob | null>((resolve) => this.composed().toBlob(resolve, "image/png"));
    this.resize();
    if (blob === null) throw new Error("the browser made no PNG file; make the window smaller");
    return blob;
  }

  /** Downloads picture() as a file. */
  async save(format: "png" | "svg", name: string): Promise<void> {
    download(await this.picture(format), `${name}.${format}`);
  }

  /** Begins a video of everything that is shown from now on; stopRecording() ends it. Throws Error where the browser records none. */
  startRecording(framesPerSecond = 30): void {
    this.recording = new Recording(this.agents.width, this.agents.height, framesPerSecond);
    this.redraw();
  }

  get isRecording(): boolean {
    return this.recording !== undefined;
  }

  /** The video, WebM or MP4 as the browser makes it. Contract: isRecording. */
  async stopRecording(): Promise<Blob> {
    const recording = this.recording as Recording;
    this.recording = undefined;
    return recording.stop();
  }

  /** Loads the frame once more, as a new one, and draws it. For measurements. */
  drawAnew(): void {
    this.renderer.load(this.frame, this.paint);
    this.paintNow();
  }

  /** Draws once; the milliseconds until the page has handed the picture over, and until it is there. */
  measureFrame(): { handedOver: number; drawn: number } {
    this.renderer.finish();
    const start = performance.now();
    this.drawAnew();
    const handedOver = performance.now() - start;
    this.renderer.finish();
    return { handedOver, drawn: performance.now() - start };
  }

  dispose(): void {
    cancelAnimationFrame(this.scheduled);
    this.observer.disconnect();
    this.renderer.dispose();
    this.beneath.dispose();
    this.agents.remove();
    this.over.remove();
  }

  private redraw(): void {
    if (this.scheduled !== 0) return;
    this.scheduled = requestAnimationFrame(() => {
      this.scheduled = 0;
      this.paintNow();
      this.recording?.add(this.composed());
    });
  }

  private paintNow(): void {
    this.beneath.draw(this.camera, this.pixelRatio, this.agents);
    // A dark line parts disks on any background.
    this.renderer.draw(this.camera, this.pixelRatio, LIGHT.ink);
    const context = this.context;
    const width = this.host.clientWidth;
    const height = this.host.clientHeight;
    context.setTransform(this.pixelRatio, 0, 0, this.pixelRatio, 0, 0);
    context.clearRect(0, 0, width, height);
    if (this.isEmpty) return;
    drawOverlay(
      { context, camera: this.camera, frame: this.frame, theme: this.theme, width, height },
      this.overlay,
      this.paint.legend,
    );
  }

  /** Everything on one canvas. */
  private composed(): HTMLCanvasElement {
    const canvas = document.createElement("canvas");
    canvas.width = this.agents.width;
    canvas.height = this.agents.height;
    const context = canvas.getContext("2d") as CanvasRenderingContext2D;
    const [red, green, blue] = this.theme.background.map((part) => Math.round(255 * part));
    context.fillStyle = `rgb(${red} ${green} ${blue})`;
    context.fillRect(0, 0, canvas.width, canvas.height);
    this.beneath.drawOn(context);
    context.drawImage(this.agents, 0, 0);
    context.drawImage(this.over, 0, 0);
    return canvas;
  }

  private resize(): void {
    this.setSize(Math.min(window.devicePixelRatio || 1, 2));
    this.fit(false);
    // At once: a canvas whose size changes is empty until it is painted.
    this.paintNow();
  }

  private setSize(pixelRatio: number): void {
    this.pixelRatio = pixelRatio;
    for (const canvas of [this.agents, this.over]) {
      const width = Math.max(1, Math.round(this.host.clientWidth * pixelRatio));
      const height = Math.max(1, Math.round(this.host.clientHeight * pixelRatio));
      if (canvas.width !== width) canvas.width = width;
      if (canvas.height !== height) canvas.height = height;
    }
  }

  private fit(reset: boolean): void {
    const bottom = this.paint.legend.kind === "none" ? 8 : LEGEND_HEIGHT + 4;
    this.camera.fit(this.frame.box, this.host.clientWidth, this.host.clientHeight, { x: 8, top: 8, bottom }, reset);
    this.over.style.touchAction = this.camera.isFitted ? "pan-x pan-y" : "none";
  }

  private restoreLostContext(): void {
    this.agents.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.agents.addEventListener("webglcontextrestored", () => {
      this.renderer = makeRenderer(this.agents, this.kind);
      this.renderer.load(this.frame, this.paint);
      this.redraw();
    });
  }

  private gestureTarget(): ConstructorParameters<typeof Gestures>[1] {
    const moved = (): void => {
      this.over.style.touchAction = this.camera.isFitted ? "pan-x pan-y" : "none";
      this.redraw();
    };
    return {
      isMeasuring: () => this.tool === "measure",
      pan: (dx, dy) => {
        this.camera.pan(dx, dy, this.frame.box);
        moved();
      },
      zoom: (at, factor) => {
        this.camera.zoomAt(at, factor, this.frame.box);
        moved();
      },
      reset: () => this.resetView(),
      click: (at) => this.onPick(agentAt(this.frame, this.camera.toBox(at), 6 / this.camera.scale)),
      measure: (from, to) => this.measure(this.camera.toBox(from), this.camera.toBox(to)),
      middle: () => ({ x: this.host.clientWidth / 2, y: this.host.clientHeight / 2 }),
    };
  }

  /** From centre to centre, where the ends lie on agents. */
  private measure(from: Point, to: Point): void {
    const snapped = [from, to].map((end) => {
      const row = agentAt(this.frame, end, 0);
      return row === null ? end : { x: numberAt(this.frame.positions, 2 * row), y: numberAt(this.frame.positions, 2 * row + 1) };
    }) as [Point, Point];
    const length = distance(this.frame, ...snapped);
    this.setOverlay({
      ...this.overlay,
      ruler: { from: snapped[0], to: snapped[1], label: shortNumber(Number(length.toPrecision(4))) },
    });
    this.onMeasure(length);
  }
}
