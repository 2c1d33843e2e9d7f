import type { DeclaredChart, QuantityColumn } from "../charts/run_charts.ts";
import type { Field } from "../drawing/frame.ts";
import type { SettingDescription, SettingValue } from "../engine/gridlock.ts";
import { request } from "../sources/bytes.ts";
import { readFrameBytes } from "../sources/frame_bytes.ts";
import type { SourceFrame, ValueNames } from "../sources/source.ts";

/** A setting that was changed in a run that had taken so many steps then. */
export interface SettingChange {
  readonly step: number;
  readonly key: string;
  readonly before: SettingValue;
  readonly value: SettingValue;
}

/** What is known of a run before its first frame. */
export interface LiveDescription {
  /** The runs of a model are numbered from 1; each restart begins another. */
  readonly run: number;
  readonly version: string;
  readonly name: string;
  readonly documentation: string;
  /** What the agents are called: "disks". */
  readonly agents: string;
  readonly columns: readonly string[];
  readonly valueNames: ValueNames;
  readonly fields: readonly string[];
  readonly quantities: readonly QuantityColumn[];
  readonly charts: readonly DeclaredChart[];
  readonly settings: readonly SettingDescription[];
  readonly values: Readonly<Record<string, SettingValue>>;
  readonly changes: readonly SettingChange[];
  readonly configuration: string;
}

/** The agents of one moment, and how the run goes. */
export interface LiveFrame extends SourceFrame {
  readonly run: number;
  /** How many settings were changed since the start. */
  readonly changes: number;
  /** Grows with all that can be seen. */
  readonly version: number;
  readonly isRunning: boolean;
  /** Steps a second that are wanted; null for as fast as it can. */
  readonly speed: number | null;
  readonly stepsPerSecond: number;
  /** What has broken the run, with the file and the line; empty where nothing has. */
  readonly problem: string;
  readonly fields: Readonly<Record<string, Field>>;
  /** Rows of the series behind those that are known, one after the other; fewer than `newRows` where there are very many. */
  readonly series: Float64Array;
  readonly newRows: number;
}

interface Head {
  readonly run: number;
  readonly changes: number;
  readonly version: number;
  readonly isRunning: boolean;
  readonly speed: number | null;
  readonly stepsPerSecond: number;
  readonly problem: string;
  readonly fields: readonly { name: string; rows: number; columns: number; offset: number }[];
  readonly series: { rows: number; kept: number; width: number; offset: number };
}

/** As it comes: a setting says besides whether another value of it needs a new start. */
type Said = Omit<LiveDescription, "settings"> & { readonly settings: readonly (SettingDescription & { readonly restarts: boolean })[] };
const BEGINS_ANEW = "Another value begins the run anew.";
const GOES_ON = "Another value holds from the next step on.";

/** Where the page comes from a program that shows a model: the server says so in the page. */
export function isLive(): boolean {
  return address() !== null;
}

function address(): string | null {
  const said = document.querySelector<HTMLMetaElement>('meta[name="gridlock-live"]')?.content;
  return said === undefined ? null : new URL(said, document.baseURI).href;
}

/** A frame as gridlock.show sends it: that of gridlock view, with fields and new rows of the series behind the columns. */
export function readLiveFrame(buffer: ArrayBuffer): LiveFrame {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))) as Head;
  const at = (offset: number): number => 4 + length + offset;
  const { run, changes, version, isRunning, speed, stepsPerSecond, problem, series } = head;
  const fields = Object.fromEntries(head.fields.map(({ name, rows, columns, offset }) => [name, { rows, columns, values: new Float32Array(buffer, at(offset), rows * columns) }]));
  return {
    ...readFrameBytes(buffer), run, changes, version, isRunning, speed, stepsPerSecond, problem, fields,
    series: new Float64Array(buffer, at(series.offset), series.kept * series.width), newRows: series.rows,
  };
}

/** The model that a program shows. All promises reject with a SourceError, whose message is for the user. */
export class LiveModel {
  private readonly address = address() as string;

  async describe(): Promise<LiveDescription> {
    const said = (await (await this.ask("about.json")).json()) as Said;
    const settings = said.settings.map((one) => ({
      ...one, documentation: `${one.documentation} ${one.restarts ? BEGINS_ANEW : GOES_ON}`.trim(), table: one.key.slice(0, Math.max(0, one.key.lastIndexOf("."))), default: null, defaultNote: "",
      least: one.least ?? -Infinity, most: one.most ?? Infinity, // JSON has no infinity
    }));
    return { ...said, settings };
  }

  /** A frame later than a version, with some columns and the rows of the series behind those that are known of a run; undefined where nothing happens. */
  async next(after: number, run: number, rows: number, columns: readonly string[]): Promise<LiveFrame | undefined> {
    const query = new URLSearchParams({ after: String(after), run: String(run), rows: String(rows), columns: columns.join() });
    const answer = await this.ask(`frame?${query}`);
    return answer.status === 204 ? undefined : readLiveFrame(await answer.arrayBuffer());
  }

  run(stepsPerSecond: number | undefined): Promise<void> {
    return this.tell("run", { stepsPerSecond: stepsPerSecond ?? null });
  }

  pause(): Promise<void> {
    return this.tell("pause");
  }

  step(): Promise<void> {
    return this.tell("step");
  }

  restart(): Promise<void> {
    return this.tell("restart");
  }

  /** Goes on with another value of a setting, or begins anew with it where the run cannot go on. */
  set(key: string, value: string): Promise<void> {
    return this.tell("set", { key, value });
  }

  private ask(path: string, options: RequestInit = {}): Promise<Response> {
    return request(`${this.address}${path}`, options, "Was the model closed, or has its program ended? Show it again, and open the new address.");
  }

  private async tell(command: string, wish: object = {}): Promise<void> {
    await this.ask(command, { method: "POST", body: JSON.stringify(wish) });
  }
}
