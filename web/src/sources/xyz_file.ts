import createXyzReader, { packedModule, type Answer, type ReadFrame, type XyzModule } from "virtual:gridlock-xyz";

import { numberAt, type Box, type Numbers } from "../drawing/frame.ts";
import { instantiate } from "../engine/instantiate.ts";
import type { Bytes } from "./bytes.ts";
import { SourceError, type Description, type SourceFrame } from "./source.ts";
import type { FrameReader } from "./source_worker.ts";

/** Made for the first file. */
let reader: Promise<XyzModule> | undefined;

const NEWLINE = 10;
const PIECE = 1 << 22;
const MOST_ATOMS = 2 ** 31;

interface Place {
  readonly offset: number;
  readonly length: number;
  /** Of its first line, counted from 1. */
  readonly line: number;
  /** Its first two lines. */
  readonly head: Uint8Array;
}

/** All frames of a file in extended or plain XYZ: where they are is found once, and each is read when it is asked for. */
export class XyzFile implements FrameReader {
  private constructor(private readonly module: XyzModule, private readonly bytes: Bytes, private readonly places: readonly Place[], readonly description: Description) {}

  /** Rejects with SourceError for what is no XYZ, with the line. Cost: the file is read once. */
  static async open(bytes: Bytes): Promise<XyzFile> {
    const { places, note } = await findFrames(bytes);
    if (places.length === 0) throw new SourceError(note === "" ? `${bytes.name} holds no frame` : `${bytes.name}: ${note}`);
    reader ??= instantiate(createXyzReader, packedModule);
    const module = await reader;
    // A frame that is damaged says so when it is looked at.
    const heads = places.map((place) => module.readHead(place.head, bytes.name, place.line).value ?? { step: NaN, time: NaN });
    const first = await frameAt(module, bytes, places[0] as Place);
    const description: Description = {
      agents: "agents",
      columns: Object.keys(first.frame.columns),
      steps: heads.map((head) => head.step),
      times: heads.map((head, at) => (Number.isNaN(head.time) ? at : head.time)),
      table: { times: [], quantities: [] },
      notes: [...first.notes, ...(note === "" ? [] : [`${note} The ${places.length} before are shown.`])],
    };
    return new XyzFile(module, bytes, places, description);
  }

  async frame(index: number): Promise<SourceFrame> {
    return (await frameAt(this.module, this.bytes, this.places[index] as Place)).frame;
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
    const head = new TextEncoder().encode(`${text}\n${await lines.next()}\n`);
    const passed = await lines.skip(count);
    if (passed < count) return { places, note: `the frame of line ${line} is cut off: ${passed} of its ${count} agents are there.` };
    places.push({ offset, length: lines.offset - offset, line, head });
  }
  return { places, note: "" };
}

function shortened(text: string): string {
  const shown = text.replace(/[^\x20-\x7e]/g, "?");
  return shown.length > 40 ? `${shown.slice(0, 40)}…` : shown;
}

/** The value of an answer of the reader. Throws SourceError with its words. */
function valueOf(answer: Answer<ReadFrame>, file: string): ReadFrame {
  if (answer.error === undefined) return answer.value;
  const problem = (JSON.parse(answer.error) as { problems: { what: string; hint: string; line: number }[] }).problems[0];
  const place = problem === undefined || problem.line === 0 ? file : `${file}, line ${problem.line}`;
  throw new SourceError(`${place}: ${problem?.what ?? "it cannot be read"}.`, problem?.hint ?? "");
}

async function frameAt(module: XyzModule, bytes: Bytes, place: Place): Promise<{ frame: SourceFrame; notes: readonly string[] }> {
  const read = valueOf(module.readFrame(await bytes.read(place.offset, place.length), bytes.name, place.line), bytes.name);
  const columns: Record<string, Numbers> = {};
  for (const { name, values } of read.columns) columns[name] = values;
  const { shift = 0, ...sides } = read.box ?? surround(columns["x"] as Float64Array, columns["y"] as Float64Array);
  const box = { ...sides, ...leanOf(shift, sides.width, columns) };
  return { frame: { step: read.step, time: read.time, box, ids: read.ids, columns, stateHash: "" }, notes: read.notes };
}

/** Counts from the edge, and the image in the box where the edges are periodic: other programs write unwrapped positions. */
export function putInside(values: Float64Array, edge: number, side: number, periodic: boolean): void {
  for (let row = 0; row < values.length; ++row) {
    const value = (values[row] as number) - edge;
    values[row] = periodic ? value - side * Math.floor(value / side) : value;
  }
}

/**
 * The shift of a box between −width/2 and width/2; none of a rectangle. Shifts that differ by whole widths have the same images, but agents have
 * then crossed other numbers of edges.
 */
export function leanOf(shift: number, width: number, columns: Record<string, Numbers>): Pick<Box, "shift"> {
  if (shift === 0) return {};
  const widths = Math.round(shift / width);
  const { image_x: right, image_y: up } = columns;
  if (widths !== 0 && right !== undefined && up !== undefined) {
    columns["image_x"] = Float64Array.from({ length: right.length }, (_, row) => numberAt(right, row) + widths * numberAt(up, row));
  }
  return { shift: shift - widths * width };
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
