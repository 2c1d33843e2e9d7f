import { RunCharts } from "../charts/run_charts.ts";
import { Series } from "../charts/series.ts";
import { Drawing } from "../drawing/drawing.ts";
import { toCss } from "../drawing/palettes.ts";
import { shadesOn } from "../drawing/field_layer.ts";
import type { DrawnField } from "../drawing/frame.ts";
import { LIGHT, shortNumber, type Theme } from "../drawing/overlay.ts";
import { wallsIn, type Wall } from "../drawing/walls.ts";
import { element, iconButton, select, setOptions, words } from "../page/dom.ts";
import { menu, type MenuItem } from "../page/menu.ts";
import { copy, notice } from "../page/notices.ts";
import type { ThemeSwitch } from "../page/theme.ts";
import { Controls, nameOf } from "../playground/controls.ts";
import { Transport } from "../playground/transport.ts";
import { textOf } from "../sources/source.ts";
import { colouringOf, coloursOf, toDrawn, usualColour, ValueRange } from "../viewer/colours.ts";
import { Selection } from "../viewer/selection.ts";
import { LiveModel, type LiveDescription, type LiveFrame, type SettingChange } from "./live_model.ts";

const CHART_MILLISECONDS = 200; // between two drawings of the charts
const HIDDEN_MILLISECONDS = 1000; // between two frames of a page that nobody sees
const MOST_TRIES = 3;
const NO_FIELD = "";
/** Columns that make the shape of an agent and its direction. */
const SHAPES = ["radius", "direction", "heading_x", "heading_y", "velocity_x", "velocity_y"];

/** A model that runs in a program elsewhere: its picture, its charts, and the keys and sliders that move it. */
export class LiveView {
  readonly element = element("div", { class: "panel playground viewer" });
  readonly drawing: Drawing;
  private readonly model = new LiveModel();
  private readonly picture = element("div", { class: "picture" });
  private readonly tools = element("div", { class: "tools", role: "group", "aria-label": "Picture" });
  private readonly charts = new RunCharts();
  private readonly transport: Transport;
  private readonly title = element("h2", {}, "Model");
  private readonly about = element("p", { class: "hint" });
  private readonly problem = element("div", { class: "problem", role: "alert", hidden: true });
  private readonly settings = element("div", { class: "group" });
  private readonly changes = element("ul", { class: "hint", "aria-label": "Changes of settings in this run" });
  private readonly colour = select("Colour by", [], "", (name) => this.colourBy(name));
  private readonly field = select("Field beneath", [], "", () => this.draw());
  private readonly fieldChoice = element("label", { class: "field row" }, element("span", { class: "name" }, "Field"), this.field);
  private readonly fieldBar = element("span", { class: "bar-of-field" });
  private readonly fieldEnds = [element("span", {}), element("span", {})] as const;
  private readonly fieldLegend = element("div", { class: "field-legend" }, this.fieldEnds[0], this.fieldBar, this.fieldEnds[1]);
  private readonly selection = new Selection();
  private readonly range = new ValueRange();
  private readonly fieldRange = new ValueRange();
  private controls: Controls | undefined;
  private described: LiveDescription | undefined;
  private walls: readonly Wall[] = [];
  private frame: LiveFrame | undefined;
  private series = new Series([]);
  private rows = 0;
  private chosenColour = "";
  private chartsShown = 0;
  private theme: Theme = LIGHT;
  private adds = false;
  /** Values of settings that were not sent yet, and the sending of those before. */
  private readonly wishes = new Map<string, string>();
  private sending: Promise<void> | undefined;
  private refusal = "";

  /** Throws Error where the browser cannot draw. */
  constructor(theme: ThemeSwitch, private readonly onVersion: (version: string) => void) {
    this.transport = new Transport({
      toggle: () => void this.toggle(),
      step: () => void this.guard(() => this.model.step()),
      restart: () => void this.restart(),
      setSpeed: (speed) => { if (this.frame?.isRunning === true) void this.guard(() => this.model.run(speed)); },
      copyHash: () => void copy(this.frame?.stateHash ?? "", "State hash"),
    }, this.tools);
    this.build();
    this.drawing = new Drawing(this.picture);
    this.drawing.element.addEventListener("pointerup", (event) => { this.adds = event.shiftKey || event.ctrlKey || event.metaKey; }, { capture: true });
    this.drawing.onPick = (row) => this.selection.pick(row, this.adds);
    this.selection.onChange = () => { this.showOverlay(); this.askAgain(); };
    theme.follow((colours) => {
      this.theme = colours;
      this.drawing.setTheme(colours);
      this.charts.setTheme(colours);
      this.showFieldBar();
    });
  }

  /** Follows the model until its program ends. */
  async start(): Promise<void> {
    let failures = 0;
    let next = this.next();
    while (failures < MOST_TRIES) {
      try {
        const frame = await next;
        failures = 0;
        if (frame !== undefined && frame.run !== this.described?.run) await this.begin();
        else if (frame !== undefined && frame.changes !== this.described?.changes.length) this.describe(await this.model.describe());
        if (frame !== undefined && frame.run === this.described?.run) this.take(frame);
        next = this.next(); // which the model makes while this one is drawn
        next.catch(() => {});
        await nextPicture();
      } catch (error) {
        ++failures;
        this.refuse(textOf(error));
        await new Promise((resolve) => setTimeout(resolve, HIDDEN_MILLISECONDS));
        next = this.next();
      }
    }
  }

  /** What a key does; whether it does anything. */
  key(key: string): boolean {
    const acts: Readonly<Record<string, () => void>> = {
      " ": () => void this.toggle(), ".": () => void this.guard(() => this.model.step()), r: () => void this.restart(),
      c: () => this.nextColour(), "0": () => this.drawing.resetView(), Escape: () => this.selection.clear(),
    };
    acts[key]?.();
    return key in acts;
  }

  private build(): void {
    const fit = iconButton("fit", "Show the whole box", () => this.drawing.resetView(), "Show the whole box (0)");
    this.tools.append(fit, menu("Save", "save", () => this.exports()));
    const colour = element("label", { class: "field row" }, element("span", { class: "name" }, "Colour by"), this.colour);
    const look = element("div", { class: "look", role: "group", "aria-label": "Look" }, colour, this.fieldChoice, this.fieldLegend);
    const head = element("div", { class: "group" }, this.title, this.about, this.problem);
    const side = element("aside", { class: "side setup", "aria-label": "Model and settings" }, head, this.settings, this.changes, this.selection.element);
    const stage = element("section", { class: "stage", "aria-label": "Picture of the model" }, this.picture, this.transport.element, look);
    const charts = element("aside", { class: "side charts", "aria-label": "Charts" }, this.charts.element);
    this.element.append(stage, side, charts);
  }

  /** What the next frame has to bring: of a selected agent all. */
  private next(): Promise<LiveFrame | undefined> {
    const columns = this.described?.columns ?? [];
    const isNeeded = (name: string): boolean => name === this.chosenColour || SHAPES.includes(name) || this.selection.rows.length > 0;
    const needed = columns.filter(isNeeded);
    const { frame } = this;
    // The same moment again, where it came without a column.
    const after = frame === undefined || needed.some((name) => !(name in frame.columns)) ? 0 : frame.version;
    return this.model.next(after, this.described?.run ?? 0, this.rows, needed);
  }

  /** A run that was not seen before. */
  private async begin(): Promise<void> {
    const described = await this.model.describe();
    const isFirst = this.described === undefined;
    this.described = described;
    this.onVersion(described.version);
    this.title.textContent = words(described.name);
    this.about.textContent = described.documentation;
    this.about.hidden = described.documentation === "";
    this.walls = wallsIn(described.configuration);
    this.series = new Series(described.quantities.map(({ name }) => name));
    this.rows = 0;
    this.chartsShown = 0;
    this.range.reset();
    this.fieldRange.reset();
    this.charts.begin(described.quantities, described.charts);
    this.transport.begin();
    if (isFirst || this.controls === undefined) {
      this.controls = new Controls(described.settings, (key, value) => this.change(key, value));
      this.settings.replaceWith(this.controls.element);
    }
    this.describe(described);
    this.showChoices(described, isFirst);
  }

  /** Shows the values of settings, and what has changed since the start. */
  private describe(described: LiveDescription): void {
    this.described = described;
    if (this.wishes.size === 0 && this.sending === undefined) this.controls?.show(described.values);
    const text = ({ step, key, before, value }: SettingChange): string => `Step ${step}: ${nameOf(key)} from ${before} to ${value}`;
    this.changes.replaceChildren(...described.changes.map((change) => element("li", {}, text(change))));
    this.changes.hidden = described.changes.length === 0;
  }

  private showChoices({ columns, valueNames, fields }: LiveDescription, isFirst: boolean): void {
    const options = coloursOf(columns, 1);
    const named = columns.find((name) => name in valueNames);
    if (!options.some(({ value }) => value === this.chosenColour)) this.chosenColour = named ?? usualColour(columns);
    setOptions(this.colour, options, this.chosenColour);
    const chosen = isFirst || !fields.includes(this.field.value) ? (fields[0] ?? NO_FIELD) : this.field.value;
    setOptions(this.field, [...fields.map((name) => ({ value: name, name: words(name) })), { value: NO_FIELD, name: "none" }], chosen);
    this.fieldChoice.hidden = fields.length === 0;
  }

  private take(frame: LiveFrame): void {
    const speed = frame.speed ?? undefined;
    if (frame.speed !== this.frame?.speed || this.frame.run !== frame.run) this.transport.stepsPerSecond = speed;
    this.frame = frame;
    this.series.add(frame.series);
    this.rows += frame.newRows;
    if (frame.isRunning) this.refusal = "";
    this.showProblem();
    this.draw();
    this.selection.show(frame);
    this.transport.show({ ...frame, count: frame.ids.length, isFinished: false }, this.described?.agents ?? "agents");
    this.showCharts(frame);
  }

  private draw(): void {
    const { frame, described } = this;
    if (frame === undefined || described === undefined) return;
    const field = this.shownField(frame);
    const colouring = colouringOf(frame, this.chosenColour, this.range, undefined, described.valueNames);
    this.drawing.show({ ...toDrawn(frame), ...(field === undefined ? {} : { field }) }, colouring);
    this.drawing.describe(`${frame.ids.length} ${described.agents} at step ${frame.step}, coloured by ${words(this.chosenColour)}. ` +
      "Arrow keys move the picture, plus and minus zoom, 0 shows all, Enter selects the agent in the middle.");
    this.showOverlay();
  }

  private shownField(frame: LiveFrame): DrawnField | undefined {
    const cells = frame.fields[this.field.value];
    this.fieldLegend.hidden = cells === undefined;
    if (cells === undefined) return undefined;
    // A lawn that was never empty still begins at 0.
    const { least, most } = this.fieldRange.cover(this.field.value, cells.values);
    const field = { ...cells, least: Math.min(0, least), most };
    this.fieldEnds[0].textContent = shortNumber(Number(field.least.toPrecision(3)));
    this.fieldEnds[1].textContent = shortNumber(Number(field.most.toPrecision(3)));
    return field;
  }

  private showFieldBar(): void {
    const shades = shadesOn(this.theme);
    const colourAt = (at: number): string => toCss([0, 1, 2].map((part) => (shades[4 * at + part] as number) / 255) as [number, number, number]);
    this.fieldBar.style.background = `linear-gradient(to right, ${[0, 64, 128, 191, 255].map(colourAt).join(", ")})`;
  }

  private showOverlay(): void {
    this.drawing.setOverlay({ walls: this.walls, selected: this.selection.rows });
  }

  private showCharts(frame: LiveFrame): void {
    const now = performance.now();
    if (frame.isRunning && now - this.chartsShown < CHART_MILLISECONDS) return;
    this.chartsShown = now;
    this.charts.show(this.series);
  }

  private colourBy(name: string): void {
    this.chosenColour = name;
    this.colour.value = name;
    this.range.reset();
    this.draw();
    this.askAgain();
  }

  /** Of a model that stands nothing new would come, nor a column that is needed now. */
  private askAgain(): void {
    if (this.frame?.isRunning === false) void this.guard(() => this.model.pause());
  }

  private nextColour(): void {
    const all = [...this.colour.options].map((option) => option.value);
    this.colourBy(all[(all.indexOf(this.chosenColour) + 1) % all.length] as string);
  }

  private async toggle(): Promise<void> {
    const isRunning = this.frame?.isRunning === true;
    await this.guard(() => (isRunning ? this.model.pause() : this.model.run(this.transport.stepsPerSecond)));
  }

  private async restart(): Promise<void> {
    await this.guard(() => this.model.restart());
  }

  /** Sends values one after the other; of those of a setting that come meanwhile the last. */
  private change(key: string, value: string): void {
    this.wishes.set(key, value);
    this.sending ??= this.send().finally(() => { this.sending = undefined; });
  }

  private async send(): Promise<void> {
    const known = this.described;
    let isRefused = false;
    for (let wish = [...this.wishes][0]; wish !== undefined; wish = [...this.wishes][0]) {
      const [key, value] = wish;
      this.wishes.delete(key);
      isRefused = !(await this.guard(() => this.model.set(key, value))) || isRefused;
    }
    // What was refused is not shown as if it were so; what was accepted stays, until a description that has it comes.
    const described = this.described;
    if (described !== undefined && (isRefused || described !== known)) this.controls?.show(described.values);
  }

  /** Whether it was not refused; says why it was. */
  private async guard(act: () => Promise<void>): Promise<boolean> {
    try {
      await act();
      this.refuse("");
      return true;
    } catch (error) {
      this.refuse(textOf(error));
      return false;
    }
  }

  private refuse(text: string): void {
    this.refusal = text;
    this.showProblem();
  }

  private showProblem(): void {
    const text = this.refusal !== "" ? this.refusal : (this.frame?.problem ?? "");
    this.problem.hidden = text === "";
    if (this.problem.textContent !== text) this.problem.textContent = text;
  }

  private exports(): MenuItem[] {
    const { drawing, frame, described } = this;
    if (frame === undefined || described === undefined) return [{ name: "Nothing to save yet", hint: "the model has not answered", act: () => {} }];
    const save = (format: "png" | "svg") => async (): Promise<void> => {
      try {
        await drawing.save(format, `${described.name}_${frame.step}`);
      } catch (error) {
        notice(textOf(error));
      }
    };
    return [
      { name: "Picture, PNG", hint: "the view, twice as sharp as on the screen", act: save("png") },
      { name: "Picture, SVG", hint: "the view as shapes, for papers", act: save("svg") },
    ];
  }
}

/** The next picture of the browser; of a page that nobody sees, which has none, a second. */
function nextPicture(): Promise<void> {
  return new Promise((resolve) => {
    const late = setTimeout(resolve, HIDDEN_MILLISECONDS);
    requestAnimationFrame(() => {
      clearTimeout(late);
      resolve();
    });
  });
}
