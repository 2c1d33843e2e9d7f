import { PackingCharts } from "../charts/packing_charts.ts";
import { RunCharts } from "../charts/run_charts.ts";
import { Series } from "../charts/series.ts";
import { Drawing } from "../drawing/drawing.ts";
import { download, videoEnding } from "../drawing/export.ts";
import { rangeOfField } from "../drawing/field_layer.ts";
import type { FieldRange, Frame } from "../drawing/frame.ts";
import { element, iconButton, select, setOptions, words } from "../page/dom.ts";
import { menu, type MenuItem } from "../page/menu.ts";
import { copy, notice } from "../page/notices.ts";
import type { ThemeSwitch } from "../page/theme.ts";
import { FileSource } from "../sources/file_source.ts";
import { isServed, Served, type ServedContents } from "../sources/served.ts";
import { frameAtTime, SourceError, textOf, type FrameSource, type SourceFrame } from "../sources/source.ts";
import { colouringOf, coloursOf, DISPLACEMENT, gridOf, toDrawn, usualColour, ValueRange } from "./colours.ts";
import { Film } from "./film.ts";
import { FrameCache } from "./frame_cache.ts";
import { Playback } from "./playback.ts";
import { namesOfRuns, type SweepPlan } from "./run_names.ts";
import { Selection } from "./selection.ts";
import { SourcePanel } from "./source_panel.ts";

const REFRESH_MILLISECONDS = 1000;
const MOST_ROWS = 20_000; // of a chart
const SHORTEST_VIDEO = 1500; // milliseconds

/** Runs and files frame by frame: what gridlock view serves, also while it is written, and files that are dropped on the page. */
export class Viewer {
  readonly element = element("div", { class: "panel playground viewer" });
  readonly drawing: Drawing;
  readonly playback = new Playback((index) => this.showFrame(index), () => this.film.update());
  private readonly picture = element("div", { class: "picture" });
  private readonly tools = element("div", { class: "tools", role: "group", "aria-label": "Picture" });
  private readonly film = new Film(this.playback, () => void copy(this.shown?.stateHash ?? "", "State hash"), this.tools);
  private readonly panel = new SourcePanel((id) => void this.openRun(id), (files) => void this.openFiles(files), () => void this.openRun(this.run));
  private readonly colour = select("Colour by", [], "", (name) => this.colourBy(name));
  private readonly field = select("Field beneath", [], "", () => this.chooseField());
  private readonly fieldRow = element("label", { class: "field row", hidden: true }, element("span", { class: "name" }, "Field"), this.field);
  private readonly grid = element("input", { type: "checkbox", onchange: () => this.showOverlay() });
  private readonly gridField = element("label", { class: "check", hidden: true }, this.grid, "Grid of k × k cells");
  private readonly selection = new Selection();
  private readonly charts = new RunCharts();
  private readonly packing = new PackingCharts();
  private readonly noCharts = element("p", { class: "group hint", hidden: true }, "There are no quantities against time in this file.");
  private readonly range = new ValueRange();
  private readonly served = isServed() ? new Served() : undefined;
  private contents: ServedContents | undefined;
  private run = "";
  private source: FrameSource | undefined;
  private cache: FrameCache | undefined;
  private shown: SourceFrame | undefined;
  private fieldRange: FieldRange | undefined; // of the frames of the field that were shown
  private chosenColour = "";
  private opened = 0; // how many sources were asked for: of two the later one counts
  private adds = false; // whether the click that comes adds to the selection

  /** Throws Error where the browser cannot draw. */
  constructor(theme: ThemeSwitch, private readonly onVersion: (version: string) => void) {
    this.build();
    this.drawing = new Drawing(this.picture);
    this.drawing.element.addEventListener("pointerup", (event) => { this.adds = event.shiftKey || event.ctrlKey || event.metaKey; }, { capture: true });
    this.drawing.onPick = (row) => this.selection.pick(row, this.adds);
    this.selection.onChange = () => this.showOverlay();
    this.charts.onChoose = (time) => { if (this.source !== undefined) void this.playback.choose(frameAtTime(this.source.description.times, time)); };
    theme.follow((colours) => { this.drawing.setTheme(colours); this.charts.setTheme(colours); this.packing.setTheme(colours); });
    void this.lookForMore();
  }

  /** Opens what is served, where anything is. */
  async start(): Promise<void> {
    if (this.served === undefined) return;
    try {
      this.contents = await this.served.contents();
      this.onVersion(this.contents.version);
      const first = this.contents.runs[0];
      await this.readNames(this.contents);
      this.panel.showContents(this.contents, first ?? "");
      if (first === undefined) throw new SourceError("No run of the sweep has begun yet.", "They appear here as they begin.");
      await this.openRun(first);
    } catch (error) {
      this.panel.showProblem(textOf(error));
    }
  }

  /** Files that were dropped or chosen: the first of them that can be shown. */
  async openFiles(files: readonly File[]): Promise<void> {
    const [file] = files;
    if (file === undefined) return;
    if (files.length > 1) notice("One file at a time is shown: the first");
    await this.open(() => FileSource.open({ name: file.name, size: file.size, blob: file }), true);
  }

  /** What a key does; whether it does anything. */
  key(key: string): boolean {
    const { playback } = this;
    const acts: Readonly<Record<string, () => void>> = {
      " ": () => playback.toggle(), ".": () => void playback.choose(playback.index + 1), ",": () => void playback.choose(playback.index - 1),
      Home: () => void playback.choose(0), End: () => void playback.choose(playback.count - 1), c: () => this.nextColour(),
      g: () => { this.grid.checked = !this.grid.checked; this.showOverlay(); },
      "0": () => this.drawing.resetView(), Escape: () => this.selection.clear(),
    };
    acts[key]?.();
    return key in acts;
  }

  private build(): void {
    const measure = iconButton("measure", "Measure", () => {
      const isOn = this.drawing.tool === "select";
      this.drawing.tool = isOn ? "measure" : "select";
      measure.setAttribute("aria-pressed", String(isOn));
      if (!isOn) this.showOverlay();
    }, "Measure a distance: drag from one place to another");
    measure.setAttribute("aria-pressed", "false");
    const fit = iconButton("fit", "Show the whole box", () => this.drawing.resetView(), "Show the whole box (0)");
    this.tools.append(measure, fit, menu("Save", "save", () => this.exports()));
    const colour = element("label", { class: "field row" }, element("span", { class: "name" }, "Colour by"), this.colour);
    const look = element("div", { class: "group" }, element("h2", {}, "Look"), colour, this.fieldRow, this.gridField);
    const side = element("aside", { class: "side setup", "aria-label": "Run and look" }, this.panel.element, look, this.selection.element);
    const stage = element("section", { class: "stage", "aria-label": "Picture of the run" }, this.picture, this.film.element);
    const charts = element("aside", { class: "side charts", "aria-label": "Charts" }, this.packing.element, this.noCharts, this.charts.element);
    this.element.append(stage, side, charts);
    this.film.update();
  }

  /** The values of the runs of a sweep, which its directories only hint at. */
  private async readNames(contents: ServedContents): Promise<void> {
    if (this.served === undefined || contents.kind !== "sweep") return;
    try {
      this.panel.names = namesOfRuns(JSON.parse(await this.served.table("plan.json")) as SweepPlan);
    } catch {
      this.panel.names = new Map(); // those of the directories have to do
    }
  }

  private async openRun(id: string): Promise<void> {
    const { served, contents } = this;
    if (served === undefined || contents === undefined || id === "") return;
    this.run = id;
    await this.open(() => served.open(contents, id));
  }

  /** Shows another source, of the user's own where it is none that is served; the one before stays where it cannot be opened. */
  private async open(make: () => Promise<FrameSource>, isOwn = false): Promise<void> {
    const mine = ++this.opened;
    this.panel.showProblem(null);
    let source: FrameSource;
    try {
      source = await make();
    } catch (error) {
      if (mine === this.opened) this.panel.showProblem(textOf(error));
      return;
    }
    if (mine !== this.opened) return source.close();
    this.source?.close();
    this.source = source;
    this.cache = new FrameCache(source);
    this.shown = undefined;
    this.range.reset();
    this.selection.clear();
    this.panel.showSource(source, this.run !== "" && isOwn);
    this.film.setGrowing(source.isGrowing);
    this.showColours();
    this.showFields();
    this.beginCharts();
    void this.showPacking(isOwn);
    await this.playback.reset(source.description.steps.length, source.isGrowing);
  }

  /** Once a second, where more may come. */
  private async lookForMore(): Promise<void> {
    for (let isLost = false;;) {
      await new Promise((resolve) => setTimeout(resolve, REFRESH_MILLISECONDS));
      if (!this.element.isConnected) continue;
      try {
        await this.refreshContents();
        await this.refresh();
        if (isLost) this.panel.showProblem(null);
        isLost = false;
      } catch (error) {
        this.panel.showProblem(textOf(error));
        isLost = true;
      }
    }
  }

  private async refreshContents(): Promise<void> {
    if (this.served === undefined || (this.contents !== undefined && this.contents.kind !== "sweep" && this.source !== undefined)) return;
    const contents = await this.served.contents();
    const isOther = contents.runs.length !== this.contents?.runs.length;
    this.contents = contents;
    if (isOther) {
      await this.readNames(contents);
      this.panel.showContents(contents, this.run);
    }
    // A run that had nothing to show may have something now.
    if (this.source === undefined) await this.openRun(this.run === "" ? (contents.runs[0] ?? "") : this.run);
  }

  private async refresh(): Promise<void> {
    const { source } = this;
    if (source === undefined || !source.isGrowing) return;
    const before = source.description.steps;
    const hasChanged = await source.refresh();
    if (source !== this.source || !hasChanged) return;
    const { steps } = source.description;
    if (steps.length < before.length || steps[0] !== before[0]) this.cache?.clear();
    this.panel.showSource(source, false);
    this.film.setGrowing(source.isGrowing);
    this.showCharts();
    // The tables of a protocol are written at the end.
    if (!source.isGrowing) void this.showPacking(false);
    await this.playback.setCount(steps.length);
  }

  private async showFrame(index: number): Promise<void> {
    const { source, cache } = this;
    if (source === undefined || cache === undefined) return;
    try {
      const frame = await cache.get(index);
      const first = this.chosenColour === DISPLACEMENT ? await cache.get(0) : undefined;
      if (source !== this.source) return;
      this.shown = frame;
      this.draw(frame, first);
      if (this.playback.isPlaying && index + 1 < this.playback.count) cache.prefetch(index + 1);
    } catch (error) {
      if (source !== this.source) return;
      this.playback.pause();
      this.panel.showProblem(textOf(error));
    }
  }

  private draw(frame: SourceFrame, first: SourceFrame | undefined): void {
    const { agents, valueNames } = (this.source as FrameSource).description;
    this.drawing.show({ ...toDrawn(frame), ...this.fieldOf(frame) }, colouringOf(frame, this.chosenColour, this.range, first, valueNames));
    this.drawing.describe(`${frame.ids.length} ${agents} at step ${frame.step}, coloured by ${words(this.chosenColour)}. ` +
      "Arrow keys move the picture, plus and minus zoom, 0 shows all, Enter selects the agent in the middle.");
    this.film.show(frame, agents);
    this.selection.show(frame);
    this.showOverlay();
  }

  private fieldOf(frame: SourceFrame): Pick<Frame, "field"> {
    const field = frame.fields?.[this.field.value];
    if (field === undefined) return {};
    this.fieldRange = rangeOfField(field, this.fieldRange);
    return { field: { ...field, ...this.fieldRange } };
  }

  /** The first field of a source is drawn until another is chosen. */
  private showFields(): void {
    const names = this.source?.description.fields ?? [];
    this.fieldRow.hidden = names.length === 0;
    setOptions(this.field, [...names.map((name) => ({ value: name, name: words(name) })), { value: "", name: "none" }], names[0] ?? "");
    this.fieldRange = undefined;
  }

  private chooseField(): void {
    this.fieldRange = undefined;
    void this.showFrame(this.playback.index);
  }

  private showOverlay(): void {
    const grid = this.shown === undefined ? undefined : gridOf(this.shown);
    this.gridField.hidden = grid === undefined;
    const walls = this.source?.description.walls ?? [];
    this.drawing.setOverlay({ walls, selected: this.selection.rows, ...(this.grid.checked && grid !== undefined ? { grid } : {}) });
  }

  private showColours(): void {
    const { columns, steps } = (this.source as FrameSource).description;
    const options = coloursOf(columns, (this.source as FrameSource).isGrowing ? Infinity : steps.length);
    if (!options.some((one) => one.value === this.chosenColour)) this.chosenColour = usualColour(columns);
    setOptions(this.colour, options, this.chosenColour);
  }

  private colourBy(name: string): void {
    this.chosenColour = name;
    this.colour.value = name;
    this.range.reset();
    void this.showFrame(this.playback.index);
  }

  private nextColour(): void {
    const all = [...this.colour.options].map((option) => option.value);
    if (all.length > 0) this.colourBy(all[(all.indexOf(this.chosenColour) + 1) % all.length] as string);
  }

  private beginCharts(): void {
    const { quantities } = (this.source as FrameSource).description.table;
    this.noCharts.hidden = quantities.length > 0;
    this.charts.element.hidden = quantities.length === 0;
    this.charts.begin(quantities.map(({ name, unit }) => ({ name, unit, documentation: "" })));
    this.showCharts();
  }

  /** The stages of the protocol of a run that is served. */
  private async showPacking(isOwn: boolean): Promise<void> {
    const { source, served } = this;
    const tables = served === undefined || isOwn ? undefined : await served.packing(this.run);
    if (source !== this.source) return;
    this.packing.show(tables);
    // A packing without a run after it has one sample, of no time.
    const { times } = (source as FrameSource).description.table;
    if (tables !== undefined && times.length < 2) [this.noCharts.hidden, this.charts.element.hidden] = [true, true];
  }

  private showCharts(): void {
    this.charts.show(this.series());
  }

  private series(): Series {
    const { times, quantities } = (this.source as FrameSource).description.table;
    const series = new Series(["time", ...quantities.map((one) => one.name)], MOST_ROWS);
    const row = new Float64Array(quantities.length + 1);
    times.forEach((time, at) => {
      row[0] = time;
      quantities.forEach((one, place) => { row[place + 1] = one.values[at] ?? NaN; });
      series.add(row);
    });
    return series;
  }

  private exports(): MenuItem[] {
    const { drawing, source, shown } = this;
    if (source === undefined || shown === undefined) return [{ name: "Nothing to save yet", hint: "open a run or a file", act: () => {} }];
    const name = (source.name.split("/").filter((part) => part !== "").at(-1) ?? "frames").replace(/\.[^.]*$/, "");
    const place = Number.isFinite(shown.step) ? shown.step : this.playback.index;
    const guarded = (act: () => Promise<void>) => async (): Promise<void> => {
      try {
        await act();
      } catch (error) {
        notice(textOf(error));
      }
    };
    return [
      { name: "Picture, PNG", hint: "the view, twice as sharp as on the screen", act: guarded(() => drawing.save("png", `${name}_${place}`)) },
      { name: "Picture, SVG", hint: "the view as shapes, for papers", act: guarded(() => drawing.save("svg", `${name}_${place}`)) },
      drawing.isRecording
        ? { name: "End the video", hint: "and save it so far", act: async () => this.playback.pause() }
        : { name: "Video to the last frame", hint: "from this frame, at the pace that is set", act: guarded(() => this.recordVideo(name)) },
    ];
  }

  /** Plays from here to the end, or until it is paused, and saves that. */
  private async recordVideo(name: string): Promise<void> {
    if (this.playback.count < 2) throw new SourceError("A video needs two frames or more.");
    const begun = performance.now();
    this.drawing.startRecording();
    notice("The video is being made: pause to end it");
    await this.playback.play();
    // The last frame is to be seen as long as the others, and encoders leave out what is shorter than their first picture takes.
    const rest = Math.max(1000 / this.playback.framesPerSecond, SHORTEST_VIDEO - (performance.now() - begun));
    await new Promise((resolve) => setTimeout(resolve, rest));
    const video = await this.drawing.stopRecording();
    if (video.size === 0) throw new SourceError("The browser has recorded nothing.", "Choose a slower pace.");
    download(video, `${name}.${videoEnding(video)}`);
  }
}
