/** Reads one file in a worker. HDF5 reads while its caller waits, which only a worker may. */

import { BlobBytes, ServedBytes } from "./bytes.ts";
import { SourceError, type Description, type SourceFrame } from "./source.ts";
import { XyzFile } from "./xyz_file.ts";

/** A file of the user's, or one on the server. */
export interface WorkerFile {
  readonly name: string;
  readonly size: number;
  readonly blob?: Blob;
  readonly address?: string;
}

export type Question =
  | { readonly kind: "open"; readonly format: "h5md" | "xyz"; readonly file: WorkerFile }
  | { readonly kind: "frame"; readonly index: number };

export interface Answer {
  readonly number: number;
  readonly value?: unknown;
  readonly error?: { readonly message: string; readonly hint: string };
}

/** What reads a format. */
export interface FrameReader {
  readonly description: Description;
  frame(index: number): Promise<SourceFrame>;
}

let reader: FrameReader | undefined;

async function answer(question: Question): Promise<unknown> {
  if (question.kind === "frame") return (reader as FrameReader).frame(question.index);
  const { file } = question;
  const bytes = file.blob === undefined ? await ServedBytes.open(file.name, file.address as string) : new BlobBytes(file.name, file.blob);
  if (question.format === "h5md") {
    // HDF5 is large, and comes only where it is needed.
    const { openH5md } = await import("./h5md_browser.ts");
    reader = await openH5md(file, bytes);
  } else {
    reader = await XyzFile.open(bytes);
  }
  return reader.description;
}

function buffersOf(value: unknown): ArrayBuffer[] {
  const frame = value as Partial<SourceFrame>;
  if (frame.ids === undefined || frame.columns === undefined) return [];
  const arrays = [frame.ids, ...Object.values(frame.columns), ...Object.values(frame.fields ?? {}).map((field) => field.values)];
  return [...new Set(arrays.map((array) => array.buffer as ArrayBuffer))];
}

self.onmessage = async (event: MessageEvent<{ number: number; question: Question }>) => {
  const { number, question } = event.data;
  try {
    const value = await answer(question);
    const sent: Answer = { number, value };
    self.postMessage(sent, { transfer: buffersOf(value) });
  } catch (error) {
    const hint = error instanceof SourceError ? error.hint : "";
    const sent: Answer = { number, error: { message: error instanceof Error ? error.message : String(error), hint } };
    self.postMessage(sent);
  }
};
