import type { PackingTables } from "../charts/packing.ts";
import { wallsIn } from "../drawing/walls.ts";
import { request, ServedBytes } from "./bytes.ts";
import { FileSource, kindOfFile } from "./file_source.ts";
import { ServedRun, type RunInfo } from "./served_run.ts";
import { packingOf } from "./protocol_tables.ts";
import { SourceError, type Description, type FrameSource } from "./source.ts";

/** What gridlock view shows. */
export interface ServedContents {
  readonly kind: "run" | "sweep" | "file";
  readonly name: string;
  readonly version: string;
  readonly tables: readonly string[];
  readonly runs: readonly string[];
}

/** Whether this page comes from gridlock view: the server says so in the page, so that a static page asks nobody. */
export function isServed(): boolean {
  return dataAddress() !== null;
}

function dataAddress(): string | null {
  const said = document.querySelector<HTMLMetaElement>('meta[name="gridlock-data"]')?.content;
  return said === undefined ? null : new URL(said, document.baseURI).href;
}

/** The runs and files that gridlock view serves. */
export class Served {
  private readonly address = dataAddress() as string;

  async contents(): Promise<ServedContents> {
    return (await (await request(`${this.address}contents.json`)).json()) as ServedContents;
  }

  /** A table of a sweep, such as sweep.csv. */
  async table(name: string): Promise<string> {
    return (await request(`${this.address}tables/${name}`)).text();
  }

  /** The frames of a run: of its trajectory, else its last state. Rejects with SourceError where it has neither. */
  async open(contents: ServedContents, id: string): Promise<FrameSource> {
    const address = `${this.address}runs/${encodeURIComponent(id)}/`;
    const info = (await (await request(`${address}about.json`)).json()) as RunInfo;
    const name = contents.kind === "sweep" ? id : contents.name;
    if (info.trajectory !== null) return this.openTrajectory(contents, name, address, info);
    const state = info.files.find((file) => kindOfFile(file.name) === "xyz");
    if (state !== undefined) return openServedFile(state.name, `${address}files/${encodeURIComponent(state.name)}`, await this.wallsOf(address, info));
    throw new SourceError(
      info.status === "unfinished" ? "The run has written no frame yet." : "The run kept no frames.",
      "A run keeps none unless it is told to: run it again with --set trajectory.every=N for a frame every N steps.");
  }

  /** The outcome of the protocol of a run; undefined for a run without one, and where its files cannot be read. */
  async packing(id: string): Promise<PackingTables | undefined> {
    const address = `${this.address}runs/${encodeURIComponent(id)}/`;
    try {
      const { files } = (await (await request(`${address}about.json`)).json()) as RunInfo;
      const text = async (name: string): Promise<string> =>
        files.some((file) => file.name === name) ? (await request(`${address}files/${name}`)).text() : "";
      const names = ["stages.csv", "levels.csv", "summary.json", "shear.csv"];
      const [stages = "", levels = "", summary = "", shear = ""] = await Promise.all(names.map(text));
      return stages === "" ? undefined : packingOf(stages, levels, summary, shear);
    } catch {
      return undefined; // the frames are shown all the same
    }
  }

  /** The walls inside the box of a run that has kept no trajectory. */
  private async wallsOf(address: string, info: RunInfo): Promise<Pick<Description, "walls">> {
    const name = "config.resolved.toml";
    if (!info.files.some((file) => file.name === name)) return {};
    return { walls: wallsIn(await (await request(`${address}files/${name}`)).text()) };
  }

  private async openTrajectory(contents: ServedContents, name: string, address: string, info: RunInfo): Promise<FrameSource> {
    try {
      return await ServedRun.open(name, address, contents.kind === "file" ? { ...info, status: "" } : info);
    } catch (error) {
      // A file of another program in H5MD is none that the library reads.
      if (contents.kind !== "file" || info.trajectory === null) throw error;
      try {
        return await openServedFile(info.trajectory, `${address}files/${encodeURIComponent(info.trajectory)}`);
      } catch {
        throw error;
      }
    }
  }
}

async function openServedFile(name: string, address: string, more: Partial<Description> = {}): Promise<FrameSource> {
  const { size } = await ServedBytes.open(name, address);
  return FileSource.open({ name, size, address }, more);
}
