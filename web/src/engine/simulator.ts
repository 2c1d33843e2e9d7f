/** A session that runs by itself, at a speed, and posts frames: what the worker does, without the worker. */

import type { PackingTables } from "../charts/packing.ts";
import type { EngineFrame, PackingContacts, SessionInfo, Speed } from "./engine_client.ts";
import { loadGridlock, type Gridlock, type NamedEstimate, type Neighbourhood, type ProtocolTable, type Session, type SettingValue, GridlockError } from "./gridlock.ts";
import { History } from "./history.ts";
import type { Catalogue } from "./protocol.ts";

/** Of work between two looks at what the page has asked for; a frame of the screen lasts 16 ms. */
const SLICE = 12;
/** A page that draws nothing for so long is hidden or busy; frames go on for charts and the clock. */
const LONGEST_WAIT = 500;
const NO_ROWS: ProtocolTable = { names: [], columns: {} };

export interface Outlets {
  frame(frame: EngineFrame): void;
  /** A run broke. */
  failure(error: unknown): void;
}

/** Waits for nothing but the messages that have arrived: no timer, which browsers delay by 4 ms. */
function otherMessages(): Promise<void> {
  return new Promise((resolve) => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => {
      channel.port1.close();
      resolve();
    };
    channel.port2.postMessage(null);
  });
}

const pause = (milliseconds: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, milliseconds));

export class Simulator {
  private gridlock: Gridlock | undefined;
  private session: Session | undefined;
  private history = new History();
  private colour = "";
  private isRunning = false;
  private run_ = 0; // counts runs, so that a loop knows whether it is still the one that is wanted
  private stepsPerSecond = Infinity;
  private isDrawn = true;
  private framePostedAt = 0;
  private seriesSent = 0;
  private seriesBegins = true;
  private lastRate = { at: 0, step: 0 };

  constructor(private readonly outlets: Outlets) {}

  async catalogue(): Promise<Catalogue> {
    const gridlock = await this.engine();
    return { version: gridlock.version, settings: gridlock.settings(), models: gridlock.models(), engines: gridlock.engines() };
  }
  async read(toml: string, overrides: readonly string[]): Promise<Readonly<Record<string, SettingValue>>> {
    return (await this.engine()).read(toml, overrides);
  }
  async merge(toml: string, overrides: readonly string[]): Promise<string> {
    return (await this.engine()).merge(toml, overrides);
  }

  async open(toml: string, overrides: readonly string[]): Promise<SessionInfo> {
    const gridlock = await this.engine();
    this.stop();
    const session = await this.opened(gridlock, toml, overrides);
    this.session?.dispose();
    this.session = session;
    this.history = new History();
    this.history.keep(session);
    if (!session.drawnColumns().some((column) => column.name === this.colour)) this.colour = "";
    this.beginSeries();
    this.postFrame();
    return {
      title: session.title,
      agentsName: session.agentsName,
      timeStep: session.timeStep,
      endStep: session.endStep,
      columns: session.columns(),
      drawnColumns: session.drawnColumns(),
      seriesColumns: session.seriesColumns(),
      configuration: session.configuration(),
      values: session.values(),
      notes: session.notes(),
      grid: session.grid(),
    };
  }

  run(speed: Speed = {}): void {
    this.opening();
    this.stepsPerSecond = speed.stepsPerSecond ?? Infinity;
    this.stop();
    this.isRunning = true;
    void this.loop(this.run_);
  }
  async pause(): Promise<void> {
    this.stop();
    if (this.session === undefined) return;
    await this.finishStep(this.session);
    this.postFrame();
  }
  async step(steps = 1): Promise<void> {
    const session = this.opening();
    this.stop();
    await this.finishStep(session);
    // A protocol knows no steps: it goes on a little.
    if (session.isPrepared) await this.advanceTo(session, session.step + steps);
    else this.advance(session, 0, SLICE);
    this.postFrame();
  }
  async restart(): Promise<void> {
    const session = this.opening();
    this.stop();
    session.restore(this.history.first());
    this.history.forgetAfter(session);
    this.beginSeries();
    this.postFrame();
  }
  async rewind(steps: number): Promise<void> {
    const session = this.opening();
    this.stop();
    const target = Math.max(0, session.step - steps);
    session.restore(this.history.before(target));
    this.history.forgetAfter(session);
    this.beginSeries();
    if (session.isPrepared) await this.advanceTo(session, target);
    this.postFrame();
  }
  lengthen(): void {
    this.opening().lengthen();
  }

  colourBy(column: string): void {
    this.colour = column;
    if (this.session !== undefined && !this.isRunning) this.postFrame();
  }
  values(id: number): Record<string, number> {
    const session = this.opening();
    const row = session.ids().indexOf(id);
    const problem = { what: `there is no agent ${id}`, hint: "", key: "", line: 0, column: 0, sourceLine: "", text: `there is no agent ${id}` };
    if (row < 0) throw new GridlockError("input", [problem]);
    return Object.fromEntries(session.columns().map(({ name }) => [name, Number(session.column(name)[row])]));
  }
  neighbourhood(id: number): Neighbourhood {
    return this.opening().neighbourhood(id);
  }
  contacts(): PackingContacts {
    return this.opening().contacts();
  }
  results(): readonly NamedEstimate[] {
    return this.opening().results();
  }
  packing(): PackingTables {
    const session = this.opening();
    const { stages = NO_ROWS, levels = NO_ROWS, shear = NO_ROWS } = session.protocolTables();
    return { stages, levels, shear, results: session.results() };
  }
  stateHash(): string {
    return this.opening().stateHash();
  }
  configuration(): string {
    return this.opening().configuration();
  }

  frameDrawn(): void {
    this.isDrawn = true;
  }

  /** For tests. */
  async breakDown(how: "trap" | "fillStack"): Promise<void> {
    (await this.engine()).breakDown(how);
  }

  private async engine(): Promise<Gridlock> {
    this.gridlock ??= await loadGridlock();
    return this.gridlock;
  }
  /** After a trap the engine is loaded anew. */
  private async opened(gridlock: Gridlock, toml: string, overrides: readonly string[]): Promise<Session> {
    try {
      return gridlock.open(toml, overrides);
    } catch (error) {
      if (!(error instanceof GridlockError) || error.kind === "input") throw error;
      this.session = undefined;
      this.gridlock = undefined;
      return (await this.engine()).open(toml, overrides);
    }
  }
  private opening(): Session {
    if (this.session !== undefined) return this.session;
    throw new Error("no set-up is open");
  }

  private stop(): void {
    this.isRunning = false;
    ++this.run_;
  }

  private async loop(run: number): Promise<void> {
    let begunAt = performance.now();
    let begunStep = this.opening().step;
    this.lastRate = { at: begunAt, step: begunStep };
    while (this.isRunning && this.run_ === run) {
      const session = this.opening();
      const isTimed = Number.isFinite(this.stepsPerSecond) && session.isPrepared;
      const due = isTimed
        ? Math.floor(((performance.now() - begunAt) / 1000) * this.stepsPerSecond) - (session.step - begunStep)
        : Number.MAX_SAFE_INTEGER;
      // Who cannot keep up does not run faster later on.
      if (due > this.stepsPerSecond / 4) [begunAt, begunStep] = [performance.now(), session.step];
      if (due > 0 && !this.advance(session, Math.max(1, Math.min(due, this.stepsPerSecond)), SLICE)) return;
      if (session.isFinished) {
        this.stop();
        this.postFrame();
        return;
      }
      const isOverdue = performance.now() - this.framePostedAt > LONGEST_WAIT;
      if ((due > 0 || !session.isPrepared) && (this.isDrawn || isOverdue)) this.postFrame();
      await (due > 0 ? otherMessages() : pause(Math.min(50, 1000 / this.stepsPerSecond)));
    }
  }

  /** Returns whether the run can go on. */
  private advance(session: Session, steps: number, milliseconds: number): boolean {
    try {
      session.advance(steps, milliseconds);
      if (this.history.isDue(session)) {
        // To go back to a step is to go back to its end.
        if (session.isWithinStep) session.advance(1);
        this.history.keepAnother(session);
      }
      return true;
    } catch (error) {
      this.stop();
      this.outlets.failure(error);
      return false;
    }
  }
  /** To a step, or to the end of a protocol where that has not come; what the page asks for meanwhile waits. */
  private async advanceTo(session: Session, step: number): Promise<void> {
    while ((session.step < step || !session.isPrepared) && !session.isFinished) {
      if (!this.advance(session, Math.max(0, step - session.step), SLICE)) return;
      if (!session.isPrepared && this.isDrawn) this.postFrame();
      await otherMessages();
    }
  }

  /** A state within a step has no hash on the command line. */
  private async finishStep(session: Session): Promise<void> {
    if (session.isWithinStep) await this.advanceTo(session, session.step + 1);
  }

  private beginSeries(): void {
    this.seriesSent = 0;
    this.seriesBegins = true;
  }

  private postFrame(): void {
    const session = this.opening();
    const now = performance.now();
    const seconds = (now - this.lastRate.at) / 1000;
    const stepsPerSecond = this.isRunning && seconds > 0 ? (session.step - this.lastRate.step) / seconds : 0;
    this.lastRate = { at: now, step: session.step };
    const positions = session.positions();
    const frame: EngineFrame = {
      step: session.step,
      time: session.time,
      box: session.box,
      count: session.count,
      ids: session.ids(),
      positions,
      radii: session.radii(),
      colour: this.colour === "" ? new Float32Array(positions.length / 2) : session.drawnColumn(this.colour),
      colourBy: this.colour,
      series: session.series(this.seriesSent),
      seriesBegins: this.seriesBegins,
      preparation: session.preparation,
      isPrepared: session.isPrepared,
      isRunning: this.isRunning,
      isFinished: session.isFinished,
      fraction: session.fraction,
      stateHash: this.isRunning ? "" : session.stateHash(),
      stepsPerSecond,
    };
    this.seriesSent = session.seriesLength;
    this.seriesBegins = false;
    this.isDrawn = false;
    this.framePostedAt = now;
    this.outlets.frame(frame);
  }
}
