/**
 * Gridlock's engines and models, compiled from the C++ library to WebAssembly: the same input gives the same bits as the
 * program of the command line. This module works in Node and in a Web Worker; a page uses `engine_client.ts`, which
 * keeps it responsive.
 *
 * ```ts
 * const gridlock = await loadGridlock();
 * const session = gridlock.open("disks.count = 400\nengine.kind = \"exact\"");
 * session.advance(1000);
 * console.log(session.step, session.stateHash());
 * session.dispose();
 * ```
 */

import createEngine, { packedModule, type Answer, type EngineModule, type SessionBinding } from "virtual:gridlock-engine";
import { instantiate } from "./instantiate.ts";

/** One thing that is wrong, in the words of the command line. */
export interface Problem {
  /** What is wrong, with the numbers. */
  readonly what: string;
  /** What to do about it; may be empty. */
  readonly hint: string;
  /** The setting to blame, "disks.packing_fraction"; may be empty. */
  readonly key: string;
  /** From 1; 0 where it is not known. */
  readonly line: number;
  /** From 1; 0 where it is not known. */
  readonly column: number;
  /** The text of that line; may be empty. */
  readonly sourceLine: string;
  /** All of it, as the command line prints it. */
  readonly text: string;
}

/**
 * `input`: the settings cannot be used. `failure`: a run that started well broke. `memory`: there is not enough of it.
 * `internal`: a mistake in Gridlock.
 */
export type ErrorKind = "input" | "failure" | "memory" | "internal";

/** What every call throws that cannot do what it is asked for. */
export class GridlockError extends Error {
  readonly kind: ErrorKind;
  /** At least one. */
  readonly problems: readonly Problem[];

  constructor(kind: ErrorKind, problems: readonly Problem[]) {
    super(problems.map((problem) => problem.text).join("\n"));
    this.name = "GridlockError";
    this.kind = kind;
    this.problems = problems;
  }
}

export type SettingValue = number | boolean | string | readonly number[] | null;

/** What is to be known of a setting to make a control of it. */
export interface SettingDescription {
  /** Dotted, "disks.packing_fraction"; of a list of tables "protocol[].kind". */
  readonly key: string;
  /** The part before the last point, "disks". */
  readonly table: string;
  readonly kind: "number" | "integer" | "switch" | "text" | "numbers" | "choice" | "tables";
  /** Empty for pure numbers and words. */
  readonly unit: string;
  /** One sentence. */
  readonly documentation: string;
  /** −Infinity where there is no bound. */
  readonly least: number;
  /** Infinity where there is no bound. */
  readonly most: number;
  readonly leastIsAllowed: boolean;
  readonly mostIsAllowed: boolean;
  /** null where leaving it out means what `defaultNote` says. */
  readonly default: SettingValue;
  readonly defaultNote: string;
  /** The words that a choice, `engine.kind` and `model.kind` take; empty for all others. */
  readonly choices: readonly string[];
}

/** A model, an engine: a name and what it is. */
export interface Named {
  readonly name: string;
  readonly documentation: string;
}

/** A column of the series. */
export interface SeriesColumn {
  readonly name: string;
  readonly unit: string;
  readonly documentation: string;
}

/** The values of a column, one for each agent. */
export type ColumnValues = Float64Array | Int32Array | Uint32Array | BigUint64Array;

export interface ColumnDescription {
  /** "x", "velocity_x", "species" … */
  readonly name: string;
  readonly type: "float64" | "int32" | "uint32" | "uint64";
  /** What the model calls the numbers 0, 1, 2 …; empty where it gives them no names. */
  readonly valueNames: readonly string[];
}

/** What agents can be coloured by. */
export interface DrawnColumn {
  readonly name: string;
  readonly unit: string;
  readonly documentation: string;
  readonly valueNames: readonly string[];
}

export interface BoxDescription {
  readonly width: number;
  readonly height: number;
  /** Along x and along y, or one answer for both. */
  readonly periodic: boolean | readonly [boolean, boolean];
  /** By how much the images above are farther to the right: 0 but in an oblique periodic box. */
  readonly shift: number;
}

/** The cells of the uniform grid. Cells are numbered row by row from the lower left corner. */
export interface GridDescription {
  readonly columns: number;
  readonly rows: number;
  readonly cellWidth: number;
  readonly cellHeight: number;
}

/** What an agent sees of the others: the 3 × 3 cells around it. */
export interface Neighbourhood {
  /** Its own cell. */
  readonly cell: number;
  /** The cells of the block, its own among them; fewer than nine at a wall. */
  readonly cells: readonly number[];
  /** The agents in them, without itself, in ascending order. */
  readonly ids: readonly number[];
  /** Those of them that touch the agent or are as near as the model looks. */
  readonly near: readonly number[];
}

export interface Preparation {
  /** From 0 to 1; 1 where there is no protocol. */
  readonly fraction: number;
  /** The stage that is carried out, "quench"; empty at the end. */
  readonly what: string;
  readonly stages: number;
  readonly finished: number;
}

export interface NamedEstimate {
  readonly name: string;
  readonly mean: number;
  /** NaN where it is not known. */
  readonly standardError: number;
  readonly unit: string;
}

/** A table by columns. */
export interface ProtocolTable {
  /** The names of its rows; empty where they have none. */
  readonly names: readonly string[];
  /** NaN where there is no value. */
  readonly columns: Readonly<Record<string, readonly number[]>>;
}

export interface Note {
  readonly severity: "info" | "note" | "warning";
  readonly text: string;
}

/** A simulation that is set up and ready to run. It is to be disposed of when it is no longer used. */
export interface Session {
  /** What advances the agents: "engine exact", "model flocking". */
  readonly title: string;
  /** What the agents are called: "disks", "birds". */
  readonly agentsName: string;
  /** Of this moment: a protocol can shear it. */
  readonly box: BoxDescription;
  readonly count: number;
  readonly step: number;
  readonly time: number;
  /** The physical time of one step. */
  readonly timeStep: number;
  /** The step at which the set-up ends; Infinity where it has no such end. */
  readonly endStep: number;
  /** Of the set-up's length that is done, from 0 to 1; 0 where it has no end. */
  readonly fraction: number;
  /** Whether the end of the set-up is reached: advance() does nothing any more, until lengthen() is called. */
  readonly isFinished: boolean;
  /** Whether the protocol has ended; advance() carries it out first. */
  readonly isPrepared: boolean;
  /** Whether the last advance() may have run out of time within a step of the exact engine: its state has no step and no hash on the
   * command line. advance(1) goes to the end of a step. */
  readonly isWithinStep: boolean;
  readonly preparation: Preparation;

  /** config.resolved.toml: every setting with the value that it has in this run. */
  configuration(): string;
  /** The same as values by dotted key. */
  values(): Readonly<Record<string, SettingValue>>;
  /** What is worth knowing of the set-up and of its protocol. */
  notes(): readonly Note[];

  /**
   * Goes on by so many steps, or until so many milliseconds have passed; returns the steps done. A protocol is carried
   * out first, which counts as no step. With `exact` the time may pass within a step.
   */
  advance(steps: number, milliseconds?: number): number;
  /** Takes the end away: the run goes on for as long as it is asked to. */
  lengthen(): void;

  columns(): readonly ColumnDescription[];
  /** A copy, in the order of `ids()`. */
  column(name: string): ColumnValues;
  /** In ascending order. */
  ids(): Float64Array;
  /** The radius of each agent; where the model gives it none, what is right for drawing. */
  radii(): Float32Array;
  /** x and y of each agent, side by side. */
  positions(): Float32Array;
  /** A column as it is drawn. Besides columns(): "displacement", "psi6", "speed" and "direction" where they are defined. */
  drawnColumn(name: string): Float32Array;
  /** The names that drawnColumn() takes, with what they are. */
  drawnColumns(): readonly DrawnColumn[];

  /** The columns of the series, step and time first. */
  seriesColumns(): readonly SeriesColumn[];
  /** The rows of the series from a row on, one after the other: those that the command line writes to series.csv. */
  series(fromRow?: number): Float64Array;
  readonly seriesLength: number;
  /** The averages so far. */
  results(): readonly NamedEstimate[];
  /** The tables "stages", "levels" and "shear", of the stages of a protocol that have ended: what the command line writes to stages.csv and so on. */
  protocolTables(): Readonly<Record<string, ProtocolTable>>;

  /** Of the state now: 16 hexadecimal digits, as `gridlock run` prints. */
  stateHash(): string;
  grid(): GridDescription;
  neighbourhood(id: number): Neighbourhood;
  /** The contacts of a packing, where a protocol has just ended in one: two ids for each, and the forces. */
  contacts(): { readonly ids: Float64Array; readonly forces: Float64Array };

  /** Everything that the rest of the run depends on. */
  save(): Uint8Array;
  /** Goes back to what was saved in a session of the same settings. Errors: `input` for other bytes; the session stays as it was. */
  restore(bytes: Uint8Array): void;
  dispose(): void;
}

export interface Gridlock {
  /** "0.2.0+0123456789ab", with the commit */
  readonly version: string;
  settings(): readonly SettingDescription[];
  models(): readonly Named[];
  engines(): readonly Named[];
  /** Reads settings without setting up a run: every setting with its value. Errors as those of open(). */
  read(toml: string, overrides?: readonly string[]): Readonly<Record<string, SettingValue>>;
  /**
   * The settings that are given, the overrides on top, one a line as TOML: short enough for a link. Errors as those of
   * read().
   */
  merge(toml: string, overrides?: readonly string[]): string;
  /**
   * Sets up a run. Overrides are "disks.count=400", as for `--set`. Errors: `input` with the texts of the command line.
   */
  open(toml: string, overrides?: readonly string[]): Session;
  /** Ends the engine as a mistake in it would, for tests: every call after it is refused. */
  breakDown(how: "trap" | "fillStack"): never;
}

/** The engine of a page or of a program; each has memory of its own. Errors: Error where WebAssembly cannot be used. */
export async function loadGridlock(): Promise<Gridlock> {
  return new LoadedGridlock(await instantiate(createEngine, packedModule));
}

/**
 * Calls into WebAssembly. What the library refuses comes back as an answer; what else is thrown is a trap, after which the memory
 * cannot be trusted, and every further call is refused.
 */
class Calls {
  private broken: GridlockError | null = null;

  make<Value>(call: () => Answer<Value>): Value {
    if (this.broken !== null) throw this.broken;
    let answer: Answer<Value>;
    try {
      answer = call();
    } catch (error) {
      this.broken = trapped(error);
      throw this.broken;
    }
    if (answer.error === undefined) return answer.value;
    const { kind, problems } = JSON.parse(answer.error) as { kind: ErrorKind; problems: Problem[] };
    throw new GridlockError(kind, problems);
  }

  json<Value>(call: () => Answer<string>): Value {
    return JSON.parse(this.make(call)) as Value;
  }
}

function trapped(error: unknown): GridlockError {
  const said = error instanceof Error ? error.message : String(error);
  const isMemory = /allocation|out of memory/i.test(said);
  const what = isMemory ? "there is not enough memory in the browser" : `the engine has stopped: ${said}`;
  const hint = isMemory ? "use fewer agents" : "this is a mistake in Gridlock; open the set-up again";
  const text = `${what}\n  hint: ${hint}`;
  return new GridlockError(isMemory ? "memory" : "internal", [{ what, hint, key: "", line: 0, column: 0, sourceLine: "", text }]);
}

interface Catalogue {
  version: string;
  settings: (Omit<SettingDescription, "least" | "most"> & { least: number | null; most: number | null })[];
  models: Named[];
  engines: Named[];
}

type Values = Readonly<Record<string, SettingValue>>;

class LoadedGridlock implements Gridlock {
  private readonly calls = new Calls();
  private readonly catalogue: Catalogue;

  constructor(private readonly module: EngineModule) {
    this.catalogue = this.calls.json(() => module.catalogue());
  }

  get version(): string {
    return this.catalogue.version;
  }
  settings(): readonly SettingDescription[] {
    return this.catalogue.settings.map((setting) => ({
      ...setting,
      least: setting.least ?? -Infinity,
      most: setting.most ?? Infinity,
    }));
  }
  models(): readonly Named[] {
    return this.catalogue.models;
  }
  engines(): readonly Named[] {
    return this.catalogue.engines;
  }
  read(toml: string, overrides: readonly string[] = []): Values {
    return this.calls.json(() => this.module.read(toml, overrides));
  }
  merge(toml: string, overrides: readonly string[] = []): string {
    return this.calls.make(() => this.module.merge(toml, overrides));
  }
  open(toml: string, overrides: readonly string[] = []): Session {
    return new OpenSession(this.calls, this.calls.make(() => this.module.open(toml, overrides)));
  }
  breakDown(how: "trap" | "fillStack"): never {
    return this.calls.make<never>(() => (how === "trap" ? this.module.trap() : this.module.fillStack(0)));
  }
}

interface Description {
  title: string;
  agentsName: string;
  columns: ColumnDescription[];
  drawnColumns: DrawnColumn[];
  seriesColumns: SeriesColumn[];
  grid: GridDescription;
}

interface Status {
  box: BoxDescription;
  count: number;
  step: number;
  time: number;
  timeStep: number;
  endStep: number | null;
  fraction: number;
  isFinished: boolean;
  isPrepared: boolean;
  isWithinStep: boolean;
  seriesLength: number;
  preparation: Preparation;
}

class OpenSession implements Session {
  private readonly description: Description;
  private status: Status;

  constructor(
    private readonly calls: Calls,
    private readonly binding: SessionBinding,
  ) {
    this.description = calls.json(() => binding.description());
    this.status = this.currentStatus();
  }

  get title(): string {
    return this.description.title;
  }
  get agentsName(): string {
    return this.description.agentsName;
  }
  get box(): BoxDescription {
    return this.status.box;
  }
  get count(): number {
    return this.status.count;
  }
  get step(): number {
    return this.status.step;
  }
  get time(): number {
    return this.status.time;
  }
  get timeStep(): number {
    return this.status.timeStep;
  }
  get endStep(): number {
    return this.status.endStep ?? Infinity;
  }
  get fraction(): number {
    return this.status.fraction;
  }
  get isFinished(): boolean {
    return this.status.isFinished;
  }
  get isPrepared(): boolean {
    return this.status.isPrepared;
  }
  get isWithinStep(): boolean {
    return this.status.isWithinStep;
  }
  get preparation(): Preparation {
    return this.status.preparation;
  }
  get seriesLength(): number {
    return this.status.seriesLength;
  }

  configuration(): string {
    return this.calls.make(() => this.binding.configuration());
  }
  values(): Values {
    return this.calls.json(() => this.binding.values());
  }
  notes(): readonly Note[] {
    return this.calls.json(() => this.binding.notes());
  }

  advance(steps: number, milliseconds = Infinity): number {
    try {
      return this.calls.make(() => this.binding.advance(steps, milliseconds));
    } finally {
      this.refresh();
    }
  }
  lengthen(): void {
    this.calls.make(() => this.binding.lengthen());
    this.refresh();
  }

  columns(): readonly ColumnDescription[] {
    return this.description.columns;
  }
  column(name: string): ColumnValues {
    return this.calls.make(() => this.binding.column(name));
  }
  ids(): Float64Array {
    return this.calls.make(() => this.binding.ids());
  }
  radii(): Float32Array {
    return this.calls.make(() => this.binding.radii());
  }
  positions(): Float32Array {
    return this.calls.make(() => this.binding.positions());
  }
  drawnColumn(name: string): Float32Array {
    return this.calls.make(() => this.binding.drawnColumn(name));
  }
  drawnColumns(): readonly DrawnColumn[] {
    return this.description.drawnColumns;
  }

  seriesColumns(): readonly SeriesColumn[] {
    return this.description.seriesColumns;
  }
  series(fromRow = 0): Float64Array {
    return this.calls.make(() => this.binding.series(fromRow));
  }
  results(): readonly NamedEstimate[] {
    const results: (Omit<NamedEstimate, "standardError"> & { standardError: number | null })[] = this.calls.json(() =>
      this.binding.results(),
    );
    return results.map((result) => ({ ...result, standardError: result.standardError ?? NaN }));
  }

  protocolTables(): Readonly<Record<string, ProtocolTable>> {
    const known = (_: string, value: unknown): unknown => (value === null ? NaN : value);
    return JSON.parse(this.calls.make(() => this.binding.protocolTables()), known) as Record<string, ProtocolTable>;
  }

  stateHash(): string {
    return this.calls.make(() => this.binding.stateHash());
  }
  grid(): GridDescription {
    return this.description.grid;
  }
  neighbourhood(id: number): Neighbourhood {
    return this.calls.json(() => this.binding.neighbourhood(id));
  }
  contacts(): { ids: Float64Array; forces: Float64Array } {
    return {
      ids: this.calls.make(() => this.binding.contactIds()),
      forces: this.calls.make(() => this.binding.contactForces()),
    };
  }

  save(): Uint8Array {
    return this.calls.make(() => this.binding.save());
  }
  restore(bytes: Uint8Array): void {
    this.calls.make(() => this.binding.restore(bytes));
    this.refresh();
  }
  dispose(): void {
    this.binding.delete();
  }

  private refresh(): void {
    this.status = this.currentStatus();
  }
  private currentStatus(): Status {
    return this.calls.json(() => this.binding.status());
  }
}
