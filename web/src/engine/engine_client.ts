/**
 * The engine in a Web Worker: the page asks, the worker simulates and posts frames whose arrays are transferred.
 *
 * ```ts
 * const engine = await EngineClient.start();
 * engine.onFrame = (frame) => draw(frame.positions, frame.radii, frame.colour);
 * const info = await engine.open(toml);
 * engine.run({ stepsPerSecond: 600 });
 * ```
 */

import type {
  BoxDescription,
  ColumnDescription,
  GridDescription,
  Named,
  NamedEstimate,
  Neighbourhood,
  Note,
  Preparation,
  SeriesColumn,
  SettingDescription,
  SettingValue,
} from "./gridlock.ts";

/** What does not change while a session runs. */
export interface SessionInfo {
  readonly title: string;
  readonly agentsName: string;
  readonly box: BoxDescription;
  readonly timeStep: number;
  readonly endStep: number;
  readonly columns: readonly ColumnDescription[];
  readonly drawnColumns: readonly { name: string; unit: string; documentation: string; valueNames: readonly string[] }[];
  readonly seriesColumns: readonly SeriesColumn[];
  readonly configuration: string;
  readonly values: Readonly<Record<string, SettingValue>>;
  readonly notes: readonly Note[];
  readonly grid: GridDescription;
}

/** What is drawn. */
export interface EngineFrame {
  readonly step: number;
  readonly time: number;
  readonly count: number;
  readonly ids: Float64Array;
  /** x, y of each agent. */
  readonly positions: Float32Array;
  readonly radii: Float32Array;
  /** The column that colourBy() has chosen. */
  readonly colour: Float32Array;
  readonly colourBy: string;
  /** New rows of the series since the last frame, one after the other. */
  readonly series: Float64Array;
  /** Whether the rows replace all that came before: after open(), restart() and rewind(). */
  readonly seriesBegins: boolean;
  readonly preparation: Preparation;
  readonly isPrepared: boolean;
  readonly isRunning: boolean;
  readonly isFinished: boolean;
  readonly fraction: number;
  /** Of the state, where the run is paused or finished; empty while it runs, for it takes time. */
  readonly stateHash: string;
  /** Achieved since the last frame. */
  readonly stepsPerSecond: number;
}

/** How fast a run goes: as fast as it can where nothing is said. */
export interface Speed {
  readonly stepsPerSecond?: number;
}

export interface EngineEvents {
  onFrame?: (frame: EngineFrame) => void;
  /** A run that breaks; the calls below reject by themselves. */
  onError?: (error: Error) => void;
}

/** All promises reject with a GridlockError as gridlock.ts throws it. */
export interface Engine extends EngineEvents {
  readonly version: string;
  readonly settings: readonly SettingDescription[];
  readonly models: readonly Named[];
  readonly engines: readonly Named[];
  read(toml: string, overrides?: readonly string[]): Promise<Readonly<Record<string, SettingValue>>>;
  merge(toml: string, overrides?: readonly string[]): Promise<string>;
  /** In place of the session before, which is kept where the new one is refused. A frame follows. */
  open(toml: string, overrides?: readonly string[]): Promise<SessionInfo>;
  run(speed?: Speed): Promise<void>;
  /** A frame with the hash follows. */
  pause(): Promise<void>;
  /** By one step, or more, to the end of them. */
  step(steps?: number): Promise<void>;
  /** Back to the start. */
  restart(): Promise<void>;
  /** Back by about so many steps: to the last saved state before, and on from there. */
  rewind(steps: number): Promise<void>;
  /** The run goes on behind its end. */
  lengthen(): Promise<void>;
  colourBy(column: string): Promise<void>;
  /** Of the current state, which pauses nothing. */
  values(id: number): Promise<Readonly<Record<string, number>>>;
  neighbourhood(id: number): Promise<Neighbourhood>;
  results(): Promise<readonly NamedEstimate[]>;
  stateHash(): Promise<string>;
  configuration(): Promise<string>;
  /** Ends the worker. */
  close(): void;
}

export async function startEngine(): Promise<Engine> {
  throw new Error("the engine is not built; ./dev build-web builds it");
}
