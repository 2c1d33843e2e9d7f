import type { Dataset, File, Group } from "h5wasm";

import type { Box, Field, Numbers } from "../drawing/frame.ts";
import { wallsIn } from "../drawing/walls.ts";
import { SourceError, type Description, type Quantity, type SourceFrame, type ValueNames } from "./source.ts";
import type { FrameReader } from "./source_worker.ts";
import { leanOf, putInside, surround } from "./xyz_file.ts";

const ABSENT_ID = 2n ** 64n - 1n;

/** A quantity of each agent: a column, or x and y of a vector; of every frame, or fixed. */
interface Element {
  readonly name: string;
  readonly data: Dataset;
  readonly isFixed: boolean;
  readonly isVector: boolean;
}

/** What is used of the module of h5wasm. */
interface Hdf5Module {
  activate_throwing_error_handler(): unknown;
}

/** Has HDF5 throw its errors instead of printing them. */
export function useHdf5(module: unknown): void {
  (module as Hdf5Module).activate_throwing_error_handler();
}

/**
 * A trajectory in H5MD, of Gridlock or of another program, in a file that h5wasm has opened. Whole numbers and floating point
 * numbers of any width become columns; what else there is is left out.
 *
 * All methods throw SourceError. Contract: errors of HDF5 are thrown, by useHdf5().
 */
export class H5mdFile implements FrameReader {
  readonly description: Description;
  private readonly position: Dataset;
  private readonly elements: readonly Element[];
  private readonly ids: Dataset | undefined;
  private readonly path: string;
  /** Observables whose numbers cannot be read. */
  private readonly damaged: string[] = [];

  constructor(private readonly name: string, private readonly file: File) {
    const agents = this.agentsGroup();
    this.path = `/particles/${agents}`;
    this.position = this.require(`${this.path}/position/value`);
    const shape = this.position.shape ?? [];
    if (shape.length !== 3 || (shape[2] as number) < 2) this.refuse("positions are not stored as [frame][agent][component]");
    this.ids = this.dataset(`${this.path}/id/value`);
    const steps = this.clock("step");
    this.elements = this.findElements();
    const frames = Math.min(shape[0] as number, steps.length);
    if (frames === 0) this.refuse("it has no frame yet");
    const times = this.clock("time").slice(0, frames);
    this.description = {
      agents,
      columns: this.elements.flatMap(columnNames),
      valueNames: this.valueNames(),
      steps: steps.slice(0, frames),
      times,
      table: { times, quantities: this.quantities(frames) },
      notes: this.notes(),
      walls: wallsIn(this.configuration()),
      fields: this.fieldNames(frames),
    };
  }

  async frame(index: number): Promise<SourceFrame> {
    try {
      return this.read(index);
    } catch (error) {
      if (error instanceof SourceError) throw error;
      return this.refuse(`frame ${index} is damaged`);
    }
  }

  private read(index: number): SourceFrame {
    const all = (this.position.shape as number[])[1] as number;
    const ids = this.idsAt(index, all);
    const columns: Record<string, Numbers> = {};
    for (const element of this.elements) this.addColumns(element, index, ids.length, columns);
    const box = this.boxAt(index, columns);
    const { steps, times } = this.description;
    const fields = Object.fromEntries((this.description.fields ?? []).map((name) => [name, this.fieldAt(name, index)]));
    return { step: steps[index] as number, time: times[index] as number, box, ids, columns, stateHash: this.stateHash(index), fields };
  }

  /** Fields of several cells, of which there are all frames. */
  private fieldNames(frames: number): string[] {
    return (this.group("/fields")?.keys() ?? []).filter((name) => {
      const data = this.dataset(`/fields/${name}/value`);
      const [stored = 0, rows = 0, columns = 0] = data?.shape ?? [];
      return data !== undefined && isNumbers(data) && data.shape?.length === 3 && stored >= frames && rows * columns > 1;
    });
  }

  private fieldAt(name: string, index: number): Field {
    const data = this.require(`/fields/${name}/value`);
    const [, rows, columns] = data.shape as [number, number, number];
    const values = data.slice([[index, index + 1], [0, rows], [0, columns]]);
    if (!ArrayBuffer.isView(values)) this.refuse(`frame ${index} is damaged: ${name} is missing`);
    return { rows, columns, values: values as unknown as Numbers };
  }

  /** Absent agents come last, and have the fill value. */
  private idsAt(index: number, all: number): Float64Array {
    if (this.ids === undefined || (this.ids.shape ?? []).length !== 2) return Float64Array.from({ length: all }, (_, row) => row);
    const ids = this.ids.slice([[index, index + 1], [0, all]]) as unknown as ArrayLike<number | bigint>;
    const end = Array.prototype.indexOf.call(ids, ABSENT_ID);
    return Float64Array.from({ length: end < 0 ? ids.length : end }, (_, row) => Number(ids[row]));
  }

  private addColumns(element: Element, index: number, count: number, columns: Record<string, Numbers>): void {
    const part = (component: number): Numbers => {
      const rows: [number, number][] = element.isFixed ? [[0, count]] : [[index, index + 1], [0, count]];
      const ranges = element.isVector ? [...rows, [component, component + 1] as [number, number]] : rows;
      const values = element.data.slice(ranges);
      if (!ArrayBuffer.isView(values) || (values as unknown as Numbers).length !== count) this.refuse(`frame ${index} is damaged: ${element.name} is missing`);
      return values as unknown as Numbers;
    };
    columnNames(element).forEach((name, component) => { columns[name] = part(component); });
  }

  private boxAt(index: number, columns: Record<string, Numbers>): Box {
    const x = Float64Array.from(columns["x"] as ArrayLike<number>);
    const y = Float64Array.from(columns["y"] as ArrayLike<number>);
    columns["x"] = x;
    columns["y"] = y;
    const sides = this.sidesAt(index);
    if (sides === undefined) return surround(x, y);
    const [width, height, shift] = sides;
    if (!(width > 0) || !(height > 0)) this.refuse(`the box of frame ${index} is ${width} × ${height}`);
    const [alongX, alongY] = this.periodicity();
    if (shift !== 0 && !(alongX && alongY)) this.refuse("its box is oblique and has walls");
    if (shift !== 0) y.forEach((value, row) => { x[row]! -= shift * Math.floor(value / height); });
    putInside(x, 0, width, alongX);
    putInside(y, 0, height, alongY);
    return { width, height, periodic: alongX === alongY ? alongX : [alongX, alongY], ...leanOf(shift, width, columns) };
  }

  /** Width, height and shift. Edges are lengths or a matrix of vectors, fixed or of each frame; without them nothing is known of the box. */
  private sidesAt(index: number): [number, number, number] | undefined {
    const box = this.group(`${this.path}/box`);
    const fixed = this.dataset(`${this.path}/box/edges`);
    const each = this.dataset(`${this.path}/box/edges/value`);
    let edges: number[] | undefined;
    if (each !== undefined) {
      const ranges = (each.shape ?? []).map((size, at): [number, number] => (at === 0 ? [index, index + 1] : [0, size]));
      edges = Array.from(each.slice(ranges) as ArrayLike<number>, Number);
    } else if (fixed !== undefined) {
      edges = Array.from(fixed.value as ArrayLike<number>, Number);
    } else if (box?.attrs["edges"] !== undefined) {
      edges = Array.from(box.attrs["edges"].value as ArrayLike<number>, Number);
    }
    if (edges === undefined || edges.length < 2) return undefined;
    const dimensions = edges.length === 4 ? 2 : edges.length === 9 ? 3 : 1;
    if (dimensions === 1) return [edges[0] as number, edges[1] as number, 0];
    if (edges[1] !== 0) this.refuse(`the first edge of its box is (${edges[0]}, ${edges[1]}), and only boxes with that edge along x are shown`);
    return [edges[0] as number, edges[dimensions + 1] as number, edges[dimensions] as number];
  }

  private periodicity(): [boolean, boolean] {
    const boundary = this.group(`${this.path}/box`)?.attrs["boundary"]?.value;
    const isPeriodic = (at: number): boolean => Array.isArray(boundary) && String(boundary[at] ?? boundary[0]).startsWith("periodic");
    return [isPeriodic(0), isPeriodic(1)];
  }

  private notes(): string[] {
    const others = this.groupsWithPositions().slice(1);
    return [
      ...(others.length === 0 ? [] : [`The file also has ${others.join(", ")}; of several groups of agents the first is shown.`]),
      ...this.damaged.map((name) => `The numbers of ${name} are damaged, so that its chart is missing.`),
    ];
  }

  private agentsGroup(): string {
    const [found] = this.groupsWithPositions();
    if (found === undefined) this.refuse("it is no trajectory in H5MD: it has no positions under /particles");
    return found as string;
  }

  private groupsWithPositions(): string[] {
    const names = this.group("/particles")?.keys() ?? [];
    return names.filter((name) => this.dataset(`/particles/${name}/position/value`) !== undefined);
  }

  private findElements(): Element[] {
    const group = this.group(this.path) as Group;
    const count = (this.position.shape as number[])[1];
    return group.keys().flatMap((name): Element[] => {
      if (name === "box" || name === "id") return [];
      const each = this.dataset(`${this.path}/${name}/value`);
      const data = each ?? this.dataset(`${this.path}/${name}`);
      if (data === undefined || !isNumbers(data)) return [];
      const rank = (data.shape ?? []).length - (each === undefined ? 0 : 1);
      if ((data.shape ?? [])[each === undefined ? 0 : 1] !== count || rank < 1 || rank > 2) return [];
      return [{ name, data, isFixed: each === undefined, isVector: rank === 2 }];
    });
  }

  private valueNames(): ValueNames {
    return Object.fromEntries(this.elements.flatMap(({ name }): [string, string[]][] => {
      const names = this.group(`${this.path}/${name}`)?.attrs["value_names"]?.value;
      return Array.isArray(names) ? [[name, names.map(String)]] : [];
    }));
  }

  /** Steps or times of the positions: one for each frame, or the distance between frames. */
  private clock(name: "step" | "time"): number[] {
    const data = this.dataset(`${this.path}/position/${name}`);
    const frames = (this.position.shape as number[])[0] as number;
    if (data === undefined) return name === "time" ? this.clock("step") : Array.from({ length: frames }, (_, index) => index);
    const value = data.value;
    if (ArrayBuffer.isView(value) && (data.shape ?? []).length === 1) return Array.from(value as unknown as ArrayLike<number | bigint>, Number);
    const every = Number(value as number | bigint);
    const offset = Number(data.attrs["offset"]?.value ?? 0);
    return Array.from({ length: frames }, (_, index) => offset + index * every);
  }

  private quantities(frames: number): Quantity[] {
    const group = this.group("/observables");
    return (group?.keys() ?? []).flatMap((name): Quantity[] => {
      const data = this.dataset(`/observables/${name}/value`);
      if (data === undefined || !isNumbers(data) || (data.shape ?? []).length !== 1 || (data.shape as number[])[0] as number < frames) return [];
      const unit = data.attrs["reduced_unit"]?.value ?? data.attrs["unit"]?.value ?? "";
      try {
        return [{ name, unit: String(unit), values: Array.from(data.slice([[0, frames]]) as ArrayLike<number>, Number) }];
      } catch {
        this.damaged.push(name);
        return [];
      }
    });
  }

  /** The settings of a run of Gridlock; empty for a file of another program. */
  private configuration(): string {
    const text = this.dataset("/parameters/configuration")?.value;
    return typeof text === "string" ? text : "";
  }

  private stateHash(index: number): string {
    const hashes = this.dataset("/parameters/frames/state_hash");
    if (hashes === undefined) return "";
    const [hash] = hashes.slice([[index, index + 1]]) as unknown as bigint[];
    return typeof hash === "bigint" ? hash.toString(16).padStart(16, "0") : "";
  }

  private dataset(path: string): Dataset | undefined {
    const found = this.find(path);
    return found?.type === "Dataset" ? (found as Dataset) : undefined;
  }

  private group(path: string): Group | undefined {
    const found = this.find(path);
    return found?.type === "Group" ? (found as Group) : undefined;
  }

  /** Looks along the names that there are: HDF5 complains of every other. */
  private find(path: string): { type: string } | undefined {
    let here: Group | undefined = this.file;
    let found: { type: string } | undefined;
    try {
      for (const name of path.split("/").filter((part) => part !== "")) {
        if (here === undefined || !here.keys().includes(name)) return undefined;
        found = here.get(name) as { type: string };
        here = found?.type === "Group" ? (found as Group) : undefined;
      }
      return found ?? undefined;
    } catch {
      return undefined;
    }
  }

  private require(path: string): Dataset {
    return this.dataset(path) ?? this.refuse(`it has no ${path}`);
  }

  private refuse(reason: string): never {
    throw new SourceError(`${this.name} cannot be shown: ${reason}.`, "Is it a trajectory in H5MD, and whole?");
  }
}

function columnNames({ name, isVector }: Element): string[] {
  if (!isVector) return [name];
  return name === "position" ? ["x", "y"] : [`${name}_x`, `${name}_y`];
}

/** Whole numbers or floating point numbers, as h5wasm calls them. */
function isNumbers(data: Dataset): boolean {
  return typeof data.dtype === "string" && /^[<>|]?[bBhHiIlLqQfd]$/.test(data.dtype);
}
