/**
 * The engine in a Web Worker: the page asks, the worker simulates and posts frames whose arrays are transferred.
 *
 * ```ts
 * const engine = startEngine();
 * engine.onFrame = (frame) => draw(frame.positions, frame.radii, frame.colour);
 * const info = await engine.open(toml);
 * engine.run({ stepsPerSecond: 600 });
 * ```
 */

import type { PackingTables } from "../charts/packing.ts";
import EngineWorker from "./engine_worker.ts?worker&inline";
import { GridlockError } from "./gridlock.ts";
import type {
  BoxDescription,
  ColumnDescription,
  DrawnColumn,
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
import type { Catalogue, Reply, Request, SentError } from "./protocol.ts";

/** What does not change while a session runs. */
export interface SessionInfo {
  readonly title: string;
  readonly agentsName: string;
  readonly timeStep: number;
  readonly endStep: number;
  readonly columns: readonly ColumnDescription[];
  readonly drawnColumns: readonly DrawnColumn[];
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
  readonly box: BoxDescription;
  readonly count: number;
  readonly ids: Float64Array;
  /** x, y of each agent. */
  readonly positions: Float32Array;
  readonly radii: Float32Array;
  /** The column that colourBy() has chosen; zeros where it has chosen none. */
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

/** Who presses on whom: two ids for each contact, and the forces. */
export interface PackingContacts {
  readonly ids: Float64Array;
  readonly forces: Float64Array;
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
  /** When what follows is known; calls need not wait for it. Rejects with an Error where the browser has no WebAssembly. */
  readonly ready: Promise<void>;
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
  /** Of a packing, where a protocol has just ended in one; else none. */
  contacts(): Promise<PackingContacts>;
  results(): Promise<readonly NamedEstimate[]>;
  /** The stages of a protocol that have ended. */
  packing(): Promise<PackingTables>;
  stateHash(): Promise<string>;
  configuration(): Promise<string>;
  /** Ends the worker, whatever it does, and starts another, in which nothing is open. open() rejects with EngineRenewed where it waits; all else that
   * waits is never answered. */
  renew(): void;
  /** Ends the worker. */
  close(): void;
}

/** A set-up was given up before it was done. */
export class EngineRenewed extends Error {}

/** Starts a worker with the engine. Throws Error where the browser has no workers. */
export function startEngine(): Engine {
  return new EngineClient();
}

interface Pending {
  readonly call: string;
  resolve(value: unknown): void;
  reject(error: Error): void;
}

const errorOf = (sent: SentError): GridlockError => new GridlockError(sent.kind, sent.problems);

class EngineClient implements Engine {
  onFrame?: (frame: EngineFrame) => void;
  onError?: (error: Error) => void;
  private catalogue: Catalogue = { version: "", settings: [], models: [], engines: [] };
  private readonly pending = new Map<number, Pending>();
  private calls = 0;
  private worker = this.newWorker();
  readonly ready = this.readCatalogue();

  private newWorker(): Worker {
    const worker = new EngineWorker();
    worker.onmessage = ({ data }: MessageEvent<Reply>) => this.take(data);
    worker.onerror = (event) => this.fail(new Error(event.message || "the engine's worker cannot be started"));
    return worker;
  }

  private async readCatalogue(): Promise<void> {
    this.catalogue = await this.call<Catalogue>("catalogue");
  }
  get version(): string {
    return this.catalogue.version;
  }
  get settings(): readonly SettingDescription[] {
    return this.catalogue.settings;
  }
  get models(): readonly Named[] {
    return this.catalogue.models;
  }
  get engines(): readonly Named[] {
    return this.catalogue.engines;
  }

  read(toml: string, overrides: readonly string[] = []): Promise<Readonly<Record<string, SettingValue>>> {
    return this.call("read", toml, overrides);
  }
  merge(toml: string, overrides: readonly string[] = []): Promise<string> {
    return this.call("merge", toml, overrides);
  }
  open(toml: string, overrides: readonly string[] = []): Promise<SessionInfo> {
    return this.call("open", toml, overrides);
  }
  run(speed: Speed = {}): Promise<void> {
    return this.call("run", speed);
  }
  pause(): Promise<void> {
    return this.call("pause");
  }
  step(steps = 1): Promise<void> {
    return this.call("step", steps);
  }
  restart(): Promise<void> {
    return this.call("restart");
  }
  rewind(steps: number): Promise<void> {
    return this.call("rewind", steps);
  }
  lengthen(): Promise<void> {
    return this.call("lengthen");
  }
  colourBy(column: string): Promise<void> {
    return this.call("colourBy", column);
  }
  values(id: number): Promise<Readonly<Record<string, number>>> {
    return this.call("values", id);
  }
  neighbourhood(id: number): Promise<Neighbourhood> {
    return this.call("neighbourhood", id);
  }
  contacts(): Promise<PackingContacts> {
    return this.call("contacts");
  }
  results(): Promise<readonly NamedEstimate[]> {
    return this.call("results");
  }
  packing(): Promise<PackingTables> {
    return this.call("packing");
  }
  stateHash(): Promise<string> {
    return this.call("stateHash");
  }
  configuration(): Promise<string> {
    return this.call("configuration");
  }
  renew(): void {
    this.worker.terminate();
    const pending = [...this.pending.values()];
    this.pending.clear();
    this.worker = this.newWorker();
    for (const one of pending) if (one.call === "open") one.reject(new EngineRenewed());
    const asked = pending.find((one) => one.call === "catalogue");
    if (asked !== undefined) this.call("catalogue").then(asked.resolve, asked.reject);
  }
  close(): void {
    this.worker.terminate();
    this.fail(new Error("the engine is closed"));
  }

  private call<Value>(call: string, ...args: unknown[]): Promise<Value> {
    const request: Request = { id: ++this.calls, call, args };
    return new Promise<Value>((resolve, reject) => {
      this.pending.set(request.id, { call, resolve: resolve as (value: unknown) => void, reject });
      this.worker.postMessage(request);
    });
  }

  private take(reply: Reply): void {
    if (reply.type === "frame") {
      this.onFrame?.(reply.frame);
      // The next one when the browser has drawn this one.
      const request: Request = { id: 0, call: "frameDrawn", args: [] };
      const { worker } = this;
      requestAnimationFrame(() => worker.postMessage(request));
    } else if (reply.type === "failure") {
      this.onError?.(errorOf(reply.error));
    } else {
      const pending = this.pending.get(reply.id);
      this.pending.delete(reply.id);
      if (reply.type === "value") pending?.resolve(reply.value);
      else pending?.reject(errorOf(reply.error));
    }
  }

  private fail(error: Error): void {
    if (this.pending.size === 0) this.onError?.(error);
    for (const pending of this.pending.values()) pending.reject(error);
    this.pending.clear();
  }
}
