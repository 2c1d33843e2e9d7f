import { RunCharts } from "../charts/run_charts.ts";
import { Series } from "../charts/series.ts";
import { Drawing } from "../drawing/drawing.ts";
import type { Frame } from "../drawing/frame.ts";
import type { Contacts, Overlay } from "../drawing/overlay.ts";
import { wallsIn, type Wall } from "../drawing/walls.ts";
import { EngineRenewed, startEngine, type Engine, type EngineFrame, type SessionInfo } from "../engine/engine_client.ts";
import { element, iconButton, select, setOptions, words } from "../page/dom.ts";
import { menu } from "../page/menu.ts";
import { copy } from "../page/notices.ts";
import type { ThemeSwitch } from "../page/theme.ts";
import { AnySetting } from "./any_setting.ts";
import { BarRange, colouringOf, coloursOf, NEIGHBOURHOOD, usualColour } from "./colours.ts";
import { Controls } from "./controls.ts";
import { Editor } from "./editor.ts";
import { exportItems } from "./exports.ts";
import type { Figure } from "./figure.ts";
import { guideElements } from "./guides.ts";
import { Inspector, rowOf } from "./inspector.ts";
import { decodeLink, encodeLink, type LinkContent } from "./link.ts";
import { commentAtTop, findScene, SCENES, withoutSweep } from "./scenes.ts";
import { densityHint, hasTime, PackingPanel } from "./packing_panel.ts";
import { Setup } from "./setup.ts";
import { Transport, USUAL_SPEED } from "./transport.ts";

const FIRST_SCENE = "paper";
const OWN = ""; // the value of the scene that is a text of the user's own
const JUST_ENDED_MILLISECONDS = 400;
const CHART_MILLISECONDS = 200; // between two drawings of the charts
/** After so long the page says that it sets up, and does not wait for the end where another set-up comes. */
const SLOW_MILLISECONDS = 700;

/** The engines in the browser: a set-up, its picture, its charts, and the keys that move it. */
export class Playground {
  readonly element = element("div", { class: "panel playground" });
  /** Begun before the page is built, which goes on meanwhile. */
  private readonly engine = startEngine();
  readonly drawing: Drawing;
  private readonly picture = element("div", { class: "picture" });
  private readonly charts = new RunCharts();
  private readonly packing = new PackingPanel();
  private readonly tools = element("div", { class: "tools", role: "group", "aria-label": "Picture" });
  private readonly transport = new Transport(
    {
      toggle: () => void this.toggle(),
      step: () => void this.step(),
      rewind: () => void this.rewind(),
      restart: () => void this.restart(),
      goTo: (step) => void this.goTo(step),
      setSpeed: (speed) => void this.setSpeed(speed),
      copyHash: () => void this.copyHash(),
    },
    this.tools,
  );
  private readonly scene = select("Scene", [], "", (name) => void this.openScene(name));
  private readonly guide = element("div", { class: "guide" });
  private readonly problem = element("div", { class: "problem", role: "alert", hidden: true });
  private readonly note = element("div", { class: "note", hidden: true });
  private readonly editor = new Editor((toml) => void this.openToml(toml));
  private readonly colour = select("Colour by", [], "", (name) => void this.colourBy(name));
  private readonly grid = element("input", { type: "checkbox", onchange: () => this.showGrid() });
  private readonly forces = element("input", { type: "checkbox", checked: true, onchange: () => this.showOverlay() });
  private readonly forcesField = element("label", { class: "check", hidden: true }, this.forces, "Forces of the packing");
  private contacts: Contacts | undefined;
  private readonly block = element("input", { type: "checkbox", checked: true, onchange: () => this.showOverlay() });
  private readonly preparation = element("div", { class: "preparation", hidden: true });
  private readonly settingUp = element(
    "div",
    { class: "preparation", role: "status", hidden: true },
    element("span", {}, "The run is being set up."),
    element("progress", { "aria-label": "Setting up" }),
    element("button", { type: "button", class: "button", onclick: () => this.stopSettingUp() }, "Stop"),
  );
  private readonly look = element("div", { class: "look", role: "group", "aria-label": "Look" });
  private readonly range = new BarRange();
  private readonly setupSide = element("aside", { class: "side setup", "aria-label": "Set-up" });
  private controls: Controls | undefined;
  private cells: Controls | undefined;
  private anySetting: AnySetting | undefined;
  private inspector: Inspector | undefined;
  private setup = new Setup("");
  private next: Setup | undefined;
  /** Ends when no set-up waits any more. */
  private opening: Promise<void> | undefined;
  private isSlow = false;
  private links = 0; // how many were opened: of two the later one counts
  private notes = 0; // of the address
  /** What the user has asked for last: a set-up that is changed meanwhile moves on. */
  private wantsToRun: boolean;
  private isAwaited = false;
  /** Frames of a session that is being opened, which come before it is described. */
  private early: EngineFrame[] = [];
  private info: SessionInfo | undefined;
  private walls: readonly Wall[] = [];
  private frame: EngineFrame | undefined;
  private series = new Series([]);
  private chosenColour = "";
  private chartsShown = 0;
  private endedAt = -Infinity;
  private merged = "";

  /** `figure`: it is part of another page. Throws Error where the browser cannot draw. */
  constructor(
    theme: ThemeSwitch,
    private readonly onVersion: (version: string) => void,
    private readonly figure?: Figure,
  ) {
    this.wantsToRun = figure?.runs === true;
    this.build();
    this.drawing = new Drawing(this.picture);
    this.drawing.onPick = (row) => this.pick(row);
    this.charts.onChoose = (time) => {
      if (this.info !== undefined) void this.goTo(Math.round(time / this.info.timeStep));
    };
    theme.follow((colours) => {
      this.drawing.setTheme(colours);
      this.charts.setTheme(colours);
      this.packing.setTheme(colours);
    });
  }

  /** Opens what the address says, and shows the controls when the engine has said what they are: before it has set up a run. */
  async start(): Promise<void> {
    const { engine } = this;
    engine.onFrame = (frame) => this.take(frame);
    engine.onError = (error) => this.showProblem(error);
    const showControls = engine.ready.then(() => {
      this.onVersion(engine.version);
      this.addControls(engine);
    });
    try {
      await Promise.all([showControls, this.openLink(location.hash)]);
    } catch (error) {
      this.showProblem(error);
    }
  }

  /** Opens the set-up of a link; the usual scene where there is none, or none that can be used, and then says why. */
  async openLink(hash: string): Promise<void> {
    const mine = ++this.links;
    let link: LinkContent = {};
    let trouble: unknown;
    try {
      link = await decodeLink(hash);
    } catch (error) {
      trouble = error;
    }
    if (mine !== this.links) return;
    this.transport.stepsPerSecond = link.stepsPerSecond ?? USUAL_SPEED;
    this.grid.checked = link.grid === true;
    this.chosenColour = link.colour ?? "";
    const known = link.scene === undefined ? undefined : findScene(link.scene);
    if (link.scene !== undefined && known === undefined) {
      trouble = new Error(`there is no scene “${link.scene}”; choose one from the list`);
    }
    if (link.toml !== undefined) await this.open(new Setup(withoutSweep(link.toml)));
    if (mine !== this.links) return;
    if (this.info === undefined || link.toml === undefined) {
      if (!this.problem.hidden) trouble = new Error(this.problem.textContent ?? "");
      await this.openScene(known?.name ?? FIRST_SCENE, link.colour);
    }
    if (trouble !== undefined && mine === this.links) this.showProblem(trouble);
  }

  /** What a key does; whether it does anything. */
  key(key: string): boolean {
    const acts: Readonly<Record<string, () => void>> = {
      " ": () => void this.toggle(),
      ".": () => void this.step(),
      ",": () => void this.rewind(),
      r: () => void this.restart(),
      c: () => this.nextColour(),
      g: () => {
        this.grid.checked = !this.grid.checked;
        this.showGrid();
      },
      l: () => void this.copyLink(),
      "0": () => this.drawing.resetView(),
      Escape: () => this.pick(null),
    };
    acts[key]?.();
    return key in acts;
  }

  private build(): void {
    const options = [...SCENES.map((one) => ({ value: one.name, name: words(one.name) })), { value: OWN, name: "your own" }];
    setOptions(this.scene, options, FIRST_SCENE);
    this.setupSide.append(
      element(
        "div",
        { class: "group" },
        element("h2", {}, "Scene"),
        this.scene,
        this.guide,
        this.problem,
        this.note,
        this.editor.element,
      ),
    );
    const fit = iconButton("fit", "Show the whole box", () => this.drawing.resetView(), "Show the whole box (0)");
    const measure = iconButton(
      "measure",
      "Measure a distance",
      () => {
        const isOn = this.drawing.tool === "select";
        this.drawing.tool = isOn ? "measure" : "select";
        measure.setAttribute("aria-pressed", String(isOn));
        if (!isOn) this.drawing.setOverlay(this.overlay());
      },
      "Measure a distance: drag from one place to another",
    );
    measure.setAttribute("aria-pressed", "false");
    const link = iconButton("link", "Copy a link to this set-up", () => void this.copyLink(), "Copy a link to this set-up (l)");
    const save = menu("Save", "save", () =>
      exportItems({
        drawing: this.drawing,
        series: this.series,
        name: this.fileName(),
        toml: this.merged,
        step: this.frame?.step ?? 0,
      }),
    );
    this.tools.append(measure, fit, link, save);
    this.picture.append(this.preparation, this.settingUp);
    const stage = element(
      "section",
      { class: "stage", "aria-label": "Picture of the run" },
      this.picture,
      this.transport.element,
      this.look,
    );
    const charts = [this.packing.element, this.charts.element];
    if (this.figure === undefined) {
      this.element.append(stage, this.setupSide, element("aside", { class: "side charts", "aria-label": "Charts" }, ...charts));
      return;
    }
    this.transport.element.before(this.problem, this.note);
    const title = element("h2", { class: "visually-hidden" }, "Charts");
    this.setupSide.replaceChildren(...(this.figure.columns.length > 0 ? [title, ...charts] : []));
    this.element.append(stage, this.setupSide);
  }

  private addControls(engine: Engine): void {
    const change = (key: string, value: string): void => void this.open((this.next ?? this.setup).with(key, value));
    this.controls = new Controls(engine.settings, change);
    this.cells = new Controls(engine.settings, (key, value) => {
      // The paper's lists are those whose cells can be chosen.
      void this.open((this.next ?? this.setup).with(key, value).with("engine.grid", "linked"));
    });
    this.anySetting = new AnySetting(engine.settings, change);
    this.inspector = new Inspector(engine, () => this.showOverlay());
    const colour = element("label", { class: "field row" }, element("span", { class: "name" }, "Colour by"), this.colour);
    const grid = element("label", { class: "check" }, this.grid, "Grid of k × k cells");
    const block = element("label", { class: "check", title: "Around the agent that was clicked" }, this.block, "3 × 3 block");
    this.look.append(colour, grid, block, this.forcesField);
    if (this.figure !== undefined) {
      if (this.figure.settings.length > 0) this.setupSide.prepend(this.controls.element);
      return;
    }
    this.setupSide.append(
      this.controls.element,
      this.cells.element,
      this.inspector.element,
      element("div", { class: "group" }, this.anySetting.element),
    );
  }

  private async openScene(name: string, colour?: string): Promise<void> {
    const scene = findScene(name);
    if (scene === undefined) {
      this.editor.element.open = true;
      return;
    }
    this.chosenColour = colour ?? scene.colour ?? "";
    await this.open(new Setup(scene.toml, scene.name, scene.given));
  }

  private async openToml(toml: string): Promise<void> {
    this.chosenColour = "";
    await this.open(new Setup(withoutSweep(toml)));
  }

  /** Opens set-ups one after the other; of those that come meanwhile the last. Ends when none waits any more. */
  private async open(setup: Setup): Promise<void> {
    this.next = setup;
    if (this.isSlow) this.engine.renew();
    this.opening ??= this.openAll();
    await this.opening;
  }

  private async openAll(): Promise<void> {
    while (this.next !== undefined) {
      const now: Setup = this.next;
      await this.openOne(now);
      if (this.next === now) this.next = undefined;
    }
    this.opening = undefined;
    await this.noteAddress();
  }

  /** Gives up what is being set up; the run before begins anew, for its engine has gone too. */
  private stopSettingUp(): void {
    this.next = this.info === undefined ? undefined : this.setup;
    this.wantsToRun = false;
    this.engine.renew();
    if (this.info === undefined) this.showProblem(new Error("No run is set up: choose a scene, or change the set-up."));
  }

  private async openOne(setup: Setup): Promise<void> {
    const { engine } = this;
    try {
      const info = await this.described(engine, setup);
      this.setup = setup;
      this.begin(info);
      this.showValues(setup);
      for (const frame of this.early) this.show(frame);
      this.merged = await engine.merge(setup.toml, setup.overrides);
      this.editor.show(this.shownToml(), !setup.isChanged);
      if (this.wantsToRun) await engine.run(this.speed());
    } catch (error) {
      this.showProblem(error);
      this.showValues(setup);
    }
  }

  /** Shows the values of the run in the controls, unless they were moved on since `asked` was asked for: they show what waits then. */
  private showValues(asked: Setup): void {
    if (this.info === undefined || (this.next !== undefined && this.next !== asked)) return;
    const { values } = this.info;
    this.controls?.show(values, this.figure?.settings);
    const hasCells = values["model.kind"] === "disks" && values["engine.kind"] === "stepped";
    this.cells?.show(values, hasCells ? ["engine.cells"] : []);
  }

  private async described(engine: Engine, setup: Setup): Promise<SessionInfo> {
    this.early = [];
    this.isAwaited = true;
    const slow = setTimeout(() => this.showSettingUp(true), SLOW_MILLISECONDS);
    try {
      return await engine.open(setup.toml, setup.overrides);
    } finally {
      clearTimeout(slow);
      this.showSettingUp(false);
      this.isAwaited = false;
    }
  }

  private showSettingUp(isSlow: boolean): void {
    this.isSlow = isSlow;
    this.settingUp.hidden = !isSlow;
  }

  private shownToml(): string {
    return this.setup.isChanged ? this.merged : this.setup.toml;
  }

  private begin(info: SessionInfo): void {
    this.info = info;
    this.walls = wallsIn(info.configuration);
    this.problem.hidden = true;
    const notes = info.notes.filter((note) => note.severity !== "info");
    this.note.hidden = notes.length === 0;
    this.note.textContent = notes.map((note) => note.text).join("\n");
    this.scene.value = this.setup.sceneName ?? OWN;
    this.guide.replaceChildren(...guideElements(commentAtTop(this.setup.toml), this.setup.sceneName));
    this.anySetting?.show(info.values);
    this.series = new Series(info.seriesColumns.map((column) => column.name));
    const { figure } = this;
    this.charts.begin(info.seriesColumns.filter((column) => figure === undefined || figure.columns.includes(column.name)));
    this.packing.begin();
    this.transport.begin();
    this.range.reset();
    this.inspector?.select(null);
    const options = coloursOf(info);
    if (!options.some((one) => one.value === this.chosenColour)) this.chosenColour = usualColour(info);
    setOptions(this.colour, options, this.chosenColour);
    void this.engine.colourBy(this.columnOf(this.chosenColour));
  }

  /** The column that the engine is to send; where the page needs none, one that costs nothing to make. */
  private columnOf(colour: string): string {
    const names = (this.info?.drawnColumns ?? []).map((column) => column.name);
    return [colour, "radius", "x"].find((name) => names.includes(name)) ?? names[0] ?? "";
  }

  private take(frame: EngineFrame): void {
    if (!this.isAwaited) return this.show(frame);
    if (frame.seriesBegins) this.early = [frame];
    else if (this.early.length > 0) this.early.push(frame);
  }

  private show(frame: EngineFrame): void {
    const info = this.info;
    if (info === undefined || frame.positions.length !== 2 * frame.count) return;
    if (frame.isFinished && this.frame?.isRunning === true) this.endedAt = performance.now();
    else if (frame.seriesBegins) this.endedAt = -Infinity;
    if (frame.isFinished) this.wantsToRun = false;
    this.frame = frame;
    if (frame.seriesBegins) this.series.clear();
    this.series.add(frame.series);
    this.draw();
    this.transport.show(frame, info.agentsName);
    this.showPreparation(frame);
    for (const key of ["disks.packing_fraction", "disks.radius"]) this.controls?.setHint(key, densityHint(frame));
    void this.packing.follow(this.engine, frame);
    this.showCharts(frame);
    if (this.inspector?.id !== null) void this.inspector?.refresh(info, frame);
  }

  private draw(): void {
    const { info, frame } = this;
    if (info === undefined || frame === undefined) return;
    const colouring = colouringOf(info, frame, this.chosenColour, this.range);
    const isFlock = colouring.by === "directions" && !info.drawnColumns.some((column) => column.name === "radius");
    const shown: Frame = {
      box: frame.box,
      count: frame.count,
      positions: frame.positions,
      ...(isFlock ? { heading: frame.colour } : { radius: frame.radii }),
    };
    this.drawing.show(shown, colouring);
    this.drawing.describe(
      `${frame.count} ${info.agentsName} at step ${frame.step}, coloured by ${words(this.chosenColour)}. ` +
        "Arrow keys move the picture, plus and minus zoom, 0 shows all, Enter selects the agent in the middle.",
    );
    void this.findContacts(frame);
    this.showOverlay();
    if (performance.getEntriesByName("first picture").length === 0) performance.mark("first picture");
  }

  /** The contacts of a packing: there are some where a protocol has just ended, and nothing has moved since. */
  private async findContacts(frame: EngineFrame): Promise<void> {
    const mayHave = frame.isPrepared && frame.preparation.stages > 0 && frame.step === 0 && !frame.isRunning;
    const found = mayHave ? await this.engine.contacts() : undefined;
    if (this.frame !== frame) return;
    const had = this.contacts !== undefined;
    this.contacts =
      found === undefined || found.forces.length === 0
        ? undefined
        : { rows: found.ids.map((id) => rowOf(frame.ids, id)), forces: found.forces };
    this.forcesField.hidden = this.contacts === undefined;
    if (had || this.contacts !== undefined) this.showOverlay();
  }

  private showCharts(frame: EngineFrame): void {
    const now = performance.now();
    if (frame.isRunning && now - this.chartsShown < CHART_MILLISECONDS) return;
    this.chartsShown = now;
    this.charts.element.hidden = !hasTime(frame);
    this.charts.show(this.series);
  }

  private showPreparation(frame: EngineFrame): void {
    this.preparation.hidden = frame.isPrepared || (!frame.isRunning && frame.preparation.fraction === 0);
    if (this.preparation.hidden) return;
    const stage = `${words(frame.preparation.what)}: stage ${Math.min(frame.preparation.finished + 1, frame.preparation.stages)} of ${frame.preparation.stages}`;
    this.preparation.replaceChildren(
      element("span", {}, stage),
      element("progress", { max: 1, value: frame.preparation.fraction, "aria-label": stage }),
    );
  }

  private overlay(): Overlay {
    const { info, frame, inspector } = this;
    if (info === undefined || frame === undefined) return {};
    const { columns, rows } = info.grid;
    const selected = inspector?.id ?? null;
    return {
      walls: this.walls,
      ...(this.grid.checked ? { grid: { columns, rows } } : {}),
      ...(this.forces.checked && this.contacts !== undefined ? { contacts: this.contacts } : {}),
      ...(selected === null ? {} : { selected: [rowOf(frame.ids, selected)] }),
      ...(this.block.checked && inspector?.block !== undefined ? { block: inspector.block } : {}),
    };
  }

  private showOverlay(): void {
    this.drawing.setOverlay(this.overlay());
  }

  private showGrid(): void {
    this.showOverlay();
    void this.noteAddress();
  }

  private pick(row: number | null): void {
    const { info, frame, inspector } = this;
    if (info === undefined || frame === undefined || inspector === undefined) return;
    inspector.select(row === null ? null : (frame.ids[row] ?? null));
    this.showOverlay();
    void inspector.refresh(info, frame);
  }

  private async colourBy(name: string): Promise<void> {
    this.chosenColour = name;
    this.colour.value = name;
    this.range.reset();
    if (name === NEIGHBOURHOOD) this.grid.checked = true;
    this.draw();
    await this.engine.colourBy(this.columnOf(name));
    await this.noteAddress();
  }

  private nextColour(): void {
    const all = [...this.colour.options].map((option) => option.value);
    void this.colourBy(all[(all.indexOf(this.chosenColour) + 1) % all.length] as string);
  }

  private speed(): { stepsPerSecond?: number } {
    const speed = this.transport.stepsPerSecond;
    return speed === undefined ? {} : { stepsPerSecond: speed };
  }

  private async toggle(): Promise<void> {
    // Who wants to pause a run that has come to its end at that moment does not want it to go beyond.
    if (this.opening === undefined && performance.now() - this.endedAt < JUST_ENDED_MILLISECONDS) return;
    const isRunning = this.frame?.isRunning === true;
    this.wantsToRun = !isRunning;
    // A set-up that is being opened moves on by itself where that is wanted.
    await this.opening;
    if (this.wantsToRun === isRunning) return;
    await this.guard(async (engine) => {
      if (isRunning) return engine.pause();
      if (this.frame?.isFinished === true) await engine.lengthen();
      await engine.run(this.speed());
    });
  }

  private async step(): Promise<void> {
    this.wantsToRun = false;
    await this.guard(async (engine) => {
      if (this.frame?.isRunning === true) await engine.pause();
      if (this.frame?.isFinished === true) await engine.lengthen();
      await engine.step();
    });
  }

  /** Back by about a second of watching. */
  private async rewind(): Promise<void> {
    const second = this.transport.stepsPerSecond ?? this.frame?.stepsPerSecond ?? USUAL_SPEED;
    this.wantsToRun = false;
    await this.guard((engine) => engine.rewind(Math.max(1, Math.round(second))));
  }

  private async restart(): Promise<void> {
    this.wantsToRun = false;
    await this.guard((engine) => engine.restart());
  }

  private async goTo(step: number): Promise<void> {
    this.wantsToRun = false;
    await this.guard(async (engine) => {
      if (this.frame?.isRunning === true) await engine.pause();
      const by = step - (this.frame?.step ?? 0);
      if (by < 0) await engine.rewind(-by);
      else if (by > 0) await engine.step(by);
    });
  }

  private async setSpeed(_speed: number | undefined): Promise<void> {
    void this.noteAddress();
    if (this.frame?.isRunning === true) await this.guard((engine) => engine.run(this.speed()));
  }

  private async guard(act: (engine: Engine) => Promise<void>): Promise<void> {
    if (this.info === undefined) return;
    try {
      await act(this.engine);
    } catch (error) {
      this.showProblem(error);
    }
  }

  private linkContent(): LinkContent {
    // What has been changed is no longer the scene, with its colour.
    const sceneName = this.setup.isChanged ? undefined : this.setup.sceneName;
    const usual =
      (sceneName === undefined ? undefined : findScene(sceneName)?.colour) ??
      (this.info === undefined ? "" : usualColour(this.info));
    return {
      ...(sceneName !== undefined ? { scene: sceneName } : { toml: this.shownToml() }),
      ...(this.chosenColour === usual ? {} : { colour: this.chosenColour }),
      ...(this.grid.checked ? { grid: true } : {}),
      ...(this.transport.stepsPerSecond === USUAL_SPEED ? {} : { stepsPerSecond: this.transport.stepsPerSecond ?? Infinity }),
    };
  }

  /** The address of the page is always a link to the set-up. */
  private async noteAddress(): Promise<void> {
    const mine = ++this.notes;
    if (this.info === undefined || this.opening !== undefined) return;
    const link = await encodeLink(this.linkContent());
    // A set-up that is opened meanwhile notes its own.
    if (mine === this.notes && this.opening === undefined) history.replaceState(null, "", link);
  }

  private async copyLink(): Promise<void> {
    await this.noteAddress();
    await copy(location.href, "Link");
  }

  private async copyHash(): Promise<void> {
    await copy(await this.engine.stateHash(), "State hash");
  }

  private fileName(): string {
    return this.setup.sceneName ?? "gridlock";
  }

  private showProblem(error: unknown): void {
    if (error instanceof EngineRenewed) return;
    this.problem.hidden = false;
    this.problem.textContent = error instanceof Error ? error.message : String(error);
  }
}
