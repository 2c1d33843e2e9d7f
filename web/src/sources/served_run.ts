import { wallsIn, type Wall } from "../drawing/walls.ts";
import { request } from "./bytes.ts";
import { readFrameBytes } from "./frame_bytes.ts";
import { SourceError, type Description, type FrameSource, type Quantity, type SourceFrame, type ValueNames } from "./source.ts";
import { readSeries } from "./table.ts";

/** A run as the server tells of it. */
export interface RunInfo {
  readonly id: string;
  readonly status: string;
  readonly trajectory: string | null;
  readonly files: readonly { name: string; bytes: number }[];
}

interface TrajectoryPart {
  readonly agents: string;
  readonly configuration: string;
  readonly columns: readonly string[];
  readonly valueNames: ValueNames;
  readonly frames: number;
  readonly first: number;
  readonly steps: readonly number[];
  readonly times: readonly number[];
  readonly observables: readonly { name: string; unit: string; values: readonly (number | null)[] }[];
}

/**
 * The trajectory of a run that gridlock view serves. The server reads it by the library, which checks every frame, also while
 * the run is written; here come only the columns of the frames that are shown.
 */
export class ServedRun implements FrameSource {
  private steps: number[] = [];
  private times: number[] = [];
  private quantities: { name: string; unit: string; values: number[] }[] = [];
  private agents = "agents";
  private columns: readonly string[] = [];
  private valueNames: ValueNames = {};
  private walls: readonly Wall[] = [];
  private series: Description["table"] | undefined;
  private notes: readonly string[] = [];

  private constructor(readonly name: string, private readonly address: string, private info: RunInfo) {}

  /** `address` is that of the run, with a slash at its end. */
  static async open(name: string, address: string, info: RunInfo): Promise<ServedRun> {
    const run = new ServedRun(name, address, info);
    run.add((await (await request(`${address}trajectory.json`)).json()) as TrajectoryPart);
    await run.readSeriesAtEnd();
    return run;
  }

  get status(): string {
    return this.info.status;
  }

  /** A run that was interrupted may be resumed at any time. */
  get isGrowing(): boolean {
    return this.info.status !== "finished" && this.info.status !== "";
  }

  get description(): Description {
    const table = this.series ?? { times: this.times, quantities: this.quantities };
    const { agents, columns, valueNames, steps, times, notes, walls } = this;
    return { agents, columns, valueNames, steps, times, table, notes, walls };
  }

  async refresh(): Promise<boolean> {
    const known = this.steps.length;
    const status = this.info.status;
    this.info = (await (await request(`${this.address}about.json`)).json()) as RunInfo;
    if (this.info.trajectory === null) throw new SourceError("The trajectory of the run is gone.", "Was the run begun again?");
    this.add((await (await request(`${this.address}trajectory.json?from=${known}`)).json()) as TrajectoryPart);
    if (status !== this.info.status) await this.readSeriesAtEnd();
    return this.steps.length !== known || status !== this.info.status;
  }

  async frame(index: number): Promise<SourceFrame> {
    return readFrameBytes(await (await request(`${this.address}frames/${index}`)).arrayBuffer());
  }

  close(): void {
    // Nothing is held.
  }

  /** What comes behind what is known; a run that was begun again has fewer frames, and everything is new. */
  private add(part: TrajectoryPart): void {
    if (part.first < this.steps.length || this.quantities.length !== part.observables.length) {
      this.steps = [];
      this.times = [];
      this.quantities = part.observables.map(({ name, unit }) => ({ name, unit, values: [] }));
    }
    this.agents = part.agents;
    this.columns = part.columns;
    this.valueNames = part.valueNames;
    this.walls = wallsIn(part.configuration);
    this.steps = this.steps.concat(part.steps);
    this.times = this.times.concat(part.times);
    part.observables.forEach(({ values }, at) => {
      const quantity = this.quantities[at] as { values: number[] };
      quantity.values = quantity.values.concat(values.map((value) => value ?? NaN));
    });
  }

  /** series.csv has all samples, and is there at the end. Until then the samples at the frames have to do. */
  private async readSeriesAtEnd(): Promise<void> {
    this.series = undefined;
    this.notes = [];
    if (!this.info.files.some((file) => file.name === "series.csv")) return;
    const units = new Map(this.quantities.map((one: Quantity) => [one.name, one.unit]));
    try {
      this.series = readSeries(await (await request(`${this.address}files/series.csv`)).text(), units);
    } catch (error) {
      this.notes = [`series.csv cannot be read: ${error instanceof Error ? error.message : String(error)}. The charts show the samples at the frames.`];
    }
  }
}
