import type { Box, Numbers } from "../drawing/frame.ts";
import type { Bytes } from "./bytes.ts";
import { SourceError, type Description, type SourceFrame } from "./source.ts";
import type { FrameReader } from "./source_worker.ts";

const NEWLINE = 10;
const PIECE = 1 << 22;
const MOST_ATOMS = 2 ** 31;

interface Place {
  readonly offset: number;
  readonly length: number;
  /** Of its first line, counted from 1. */
  readonly line: number;
  readonly count: number;
  readonly comment: string;
}

/** One property of the lines of a frame: its name, S, R, I or L, its first column and how many it has. */
interface Property {
  readonly name: string;
  readonly type: string;
  readonly first: number;
  readonly width: number;
}

/** Names of extended XYZ for what Gridlock calls otherwise, as ASE and Gridlock write them. */
const GRIDLOCK_NAMES: Readonly<Record<string, string>> = { velo: "velocity", vel: "velocity", masses: "mass", radii: "radius" };

/** The entries of a comment line: key=value, with quotes around values of several words. */
export function readComment(comment: string): Map<string, string> {
  const entries = new Map<string, string>();
  for (const [, key, quoted, bare] of comment.matchAll(/([A-Za-z_][\w-]*)=(?:"([^"]*)"|(\S+))/g)) {
    entries.set((key as string).toLowerCase(), quoted ?? bare ?? "");
  }
  return entries;
}

/** All frames of a file in extended or plain XYZ: where they are is found once, and each is read when it is asked for. */
export class XyzFile implements FrameReader {
  private constructor(private readonly bytes: Bytes, private readonly places: readonly Place[], readonly description: Description) {}

  /** Rejects with SourceError for what is no XYZ, with the line. Cost: the file is read once. */
  static async open(bytes: Bytes): Promise<XyzFile> {
    const { places, note } = await findFrames(bytes);
    if (places.length === 0) throw new SourceError(note === "" ? `${bytes.name} holds no frame` : `${bytes.name}: ${note}`);
    const comments = places.map((place) => readComment(place.comment));
    const number = (entries: Map<string, string>, key: string): number => Number(entries.get(key) ?? NaN);
    const first = await frameAt(bytes, places[0] as Place);
    const description: Description = {
      agents: "agents",
      columns: Object.keys(first.columns),
      steps: comments.map((entries) => number(entries, "step")),
      times: comments.map((entries, at) => (Number.isFinite(number(entries, "time")) ? number(entries, "time") : at)),
      table: { times: [], quantities: [] },
      notes: note === "" ? [] : [`${note} The ${places.length} before are shown.`],
    };
    return new XyzFile(bytes, places, description);
  }

  frame(index: number): Promise<SourceFrame> {
    return frameAt(this.bytes, this.places[index] as Place);
  }
}

/** Lines of a file one after the other, without more than a piece of it in memory. */
class Lines {
  private piece: Uint8Array = new Uint8Array(0);
  private start = 0; // of the piece in the file
  private at = 0;
  number = 0; // of lines that were read

  constructor(private readonly bytes: Bytes) {}

  get offset(): number {
    return this.start + this.at;
  }

  get isAtEnd(): boolean {
    return this.offset >= this.bytes.size;
  }

  /** The next line as text, of which no more than `most` bytes are kept. */
  async next(most = 1 << 16): Promise<string> {
    const parts: number[] = [];
    while (!this.isAtEnd) {
      await this.fill();
      const end = this.piece.indexOf(NEWLINE, this.at);
      const until = end < 0 ? this.piece.length : end;
      const kept = this.piece.subarray(this.at, Math.min(until, this.at + Math.max(0, most - parts.length)));
      for (const byte of kept) parts.push(byte);
      this.at = end < 0 ? this.piece.length : end + 1;
      if (end >= 0) break;
    }
    ++this.number;
    return new TextDecoder().decode(Uint8Array.from(parts)).replace(/\r$/, "");
  }

  /** Passes over lines; how many there were. */
  async skip(count: number): Promise<number> {
    let passed = 0;
    while (passed < count && !this.isAtEnd) {
      await this.fill();
      const end = this.piece.indexOf(NEWLINE, this.at);
      this.at = end < 0 ? this.piece.length : end + 1;
      if (end >= 0 || this.isAtEnd) ++passed;
    }
    this.number += passed;
    return passed;
  }

  private async fill(): Promise<void> {
    if (this.at < this.piece.length) return;
    this.start += this.piece.length;
    this.piece = await this.bytes.read(this.start, PIECE);
    this.at = 0;
    if (this.piece.length === 0) throw new SourceError(`${this.bytes.name} has become shorter while it was read`);
  }
}

/** Where the frames are, and what is wrong with the last one, if anything is. */
async function findFrames(bytes: Bytes): Promise<{ places: Place[]; note: string }> {
  const lines = new Lines(bytes);
  const places: Place[] = [];
  while (!lines.isAtEnd) {
    const offset = lines.offset;
    const line = lines.number + 1;
    const text = await lines.next();
    if (text.trim() === "") continue;
    const count = /^\s*\d+\s*$/.test(text) ? Number(text) : NaN;
    if (!(count <= MOST_ATOMS)) return { places, note: `line ${line} is "${shortened(text)}", not the number of agents of a frame.` };
    const comment = await lines.next();
    const passed = await lines.skip(count);
    if (passed < count) return { places, note: `the frame of line ${line} is cut off: ${passed} of its ${count} agents are there.` };
    places.push({ offset, length: lines.offset - offset, line, count, comment });
  }
  return { places, note: "" };
}

function shortened(text: string): string {
  const shown = text.replace(/[^\x20-\x7e]/g, "?");
  return shown.length > 40 ? `${shown.slice(0, 40)}…` : shown;
}

function propertiesOf(text: string | undefined, words: number): Property[] {
  const parts = (text ?? `species:S:1:pos:R:${words >= 4 ? 3 : 2}`).split(":");
  const properties: Property[] = [];
  let first = 0;
  for (let at = 0; at + 2 < parts.length; at += 3) {
    const width = Number(parts[at + 2]);
    if (!Number.isInteger(width) || width < 1) throw new SourceError(`The properties of the comment line, "${shortened(text ?? "")}", are damaged.`);
    properties.push({ name: parts[at] as string, type: parts[at + 1] as string, first, width });
    first += width;
  }
  return properties;
}

async function frameAt(bytes: Bytes, place: Place): Promise<SourceFrame> {
  const text = new TextDecoder().decode(await bytes.read(place.offset, place.length));
  const lines = text.split("\n");
  const comment = readComment(place.comment);
  const words = (lines[2] ?? "").trim().split(/\s+/).length;
  const properties = propertiesOf(comment.get("properties"), words);
  const cells = new Cells(bytes.name, place, properties);
  for (let row = 0; row < place.count; ++row) cells.read(row, lines[row + 2] as string);
  return cells.toFrame(comment);
}

/** The columns of one frame as its lines are read. */
class Cells {
  private readonly numbers: Float64Array[];
  private readonly words: (string[] | undefined)[];
  private readonly width: number;

  constructor(private readonly file: string, private readonly place: Place, private readonly properties: readonly Property[]) {
    this.width = properties.reduce((sum, one) => sum + one.width, 0);
    this.numbers = Array.from({ length: this.width }, () => new Float64Array(0));
    this.words = new Array<string[] | undefined>(this.width);
    for (const { first, width, type } of properties) {
      for (let at = first; at < first + width; ++at) {
        if (type === "S") this.words[at] = new Array<string>(place.count);
        else this.numbers[at] = new Float64Array(place.count);
      }
    }
  }

  read(row: number, line: string): void {
    const cells = line.trim().split(/\s+/);
    if (cells.length < this.width) this.refuse(row, `has ${cells.length} of ${this.width} columns`);
    for (let at = 0; at < this.width; ++at) {
      const cell = cells[at] as string;
      const words = this.words[at];
      if (words !== undefined) {
        words[row] = cell;
        continue;
      }
      const value = cell === "T" || cell === "F" ? Number(cell === "T") : Number(cell);
      if (Number.isNaN(value) && cell.toLowerCase() !== "nan") this.refuse(row, `has "${shortened(cell)}" for a number`);
      (this.numbers[at] as Float64Array)[row] = value;
    }
  }

  toFrame(comment: Map<string, string>): SourceFrame {
    const columns: Record<string, Numbers> = {};
    let ids = Float64Array.from({ length: this.place.count }, (_, row) => row);
    for (const property of this.properties) {
      const { name, first, width } = property;
      if (name.toLowerCase() === "id" && width === 1) ids = (this.numbers[first] as Float64Array).slice();
      else Object.assign(columns, this.columnsOf(property));
    }
    if (columns["x"] === undefined || columns["y"] === undefined) throw new SourceError(`${this.file} has no positions: no property pos.`);
    const box = this.putIntoBox(comment, columns["x"] as Float64Array, columns["y"] as Float64Array);
    const number = (key: string): number => Number(comment.get(key) ?? NaN);
    return { step: number("step"), time: number("time"), box, ids, columns, stateHash: "" };
  }

  private columnsOf({ name, first, width }: Property): Record<string, Numbers> {
    const own = GRIDLOCK_NAMES[name] ?? name;
    const column = (at: number): Numbers => (this.words[at] === undefined ? (this.numbers[at] as Float64Array) : numbered(this.words[at] as string[]));
    if (name.toLowerCase() === "pos") return { x: column(first), y: column(first + 1) };
    if (width === 1) return { [own]: column(first) };
    return { [`${own}_x`]: column(first), [`${own}_y`]: column(first + 1) };
  }

  /** The box of the lattice, or the rectangle around all agents, moved to (0, 0). */
  private putIntoBox(comment: Map<string, string>, x: Float64Array, y: Float64Array): Box {
    const lattice = comment.get("lattice")?.trim().split(/\s+/).map(Number);
    if (lattice === undefined) return surround(x, y);
    const [width, tilt, , other, height] = lattice as [number, number, number, number, number];
    if (lattice.length !== 9 || !(width > 0) || !(height > 0)) throw new SourceError(`${this.file}: the lattice of line ${this.place.line + 1} is no box.`);
    if (tilt !== 0 || other !== 0) throw new SourceError(`${this.file}: the box of line ${this.place.line + 1} is sheared, and only rectangles are shown.`);
    const origin = comment.get("origin")?.trim().split(/\s+/).map(Number) ?? [0, 0];
    const periodic = /^\s*[T1]/i.test(comment.get("pbc") ?? "T");
    putInside(x, origin[0] ?? 0, width, periodic);
    putInside(y, origin[1] ?? 0, height, periodic);
    return { width, height, periodic };
  }

  private refuse(row: number, what: string): never {
    throw new SourceError(`${this.file}: line ${this.place.line + 2 + row} ${what}.`);
  }
}

/** Counts from the edge, and the image in the box where the edges are periodic: other programs write unwrapped positions. */
export function putInside(values: Float64Array, edge: number, side: number, periodic: boolean): void {
  for (let row = 0; row < values.length; ++row) {
    const value = (values[row] as number) - edge;
    values[row] = periodic ? value - side * Math.floor(value / side) : value;
  }
}

/** The rectangle around points, which are moved into it. */
export function surround(x: Float64Array, y: Float64Array): Box {
  const [left, width] = spanOf(x);
  const [bottom, height] = spanOf(y);
  const margin = 0.02 * Math.max(width, height) || 1;
  putInside(x, left - margin, width, false);
  putInside(y, bottom - margin, height, false);
  return { width: width + 2 * margin, height: height + 2 * margin, periodic: false };
}

function spanOf(values: Float64Array): [number, number] {
  let least = Infinity;
  let most = -Infinity;
  for (const value of values) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return least <= most ? [least, most - least] : [0, 0];
}

/** Words as whole numbers from 0 in alphabetical order. */
function numbered(words: readonly string[]): Int32Array {
  const names = [...new Set(words)].sort();
  const places = new Map(names.map((name, place) => [name, place]));
  return Int32Array.from(words, (word) => places.get(word) as number);
}
