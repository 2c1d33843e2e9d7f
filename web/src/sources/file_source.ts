import { BlobBytes, ServedBytes } from "./bytes.ts";
import { BYTES_OF_FORMAT, recognizeFormat } from "./file_format.ts";
import { SourceError, type Description, type FrameSource, type SourceFrame } from "./source.ts";
import type { Answer, Question, WorkerFile } from "./source_worker.ts";
import SourceWorker from "./source_worker.ts?worker&inline";

/** By the end of its name; nothing for a file that is not shown. */
export function kindOfFile(name: string): "h5md" | "xyz" | undefined {
  const ending = name.toLowerCase().replace(/^.*\./, "");
  if (ending === "h5" || ending === "h5md" || ending === "hdf5") return "h5md";
  if (ending === "xyz" || ending === "extxyz" || ending === "exyz") return "xyz";
  return undefined;
}

/** By the first bytes, and by the name where they have no mark. Throws SourceError for a file that is not shown. */
export function kindOfBytes(name: string, head: Uint8Array): "h5md" | "xyz" {
  const format = recognizeFormat(head);
  if (format?.kind === "h5md") return "h5md";
  const is = format === undefined ? "no file that can be shown here" : format.name;
  const kind = format === undefined ? kindOfFile(name) : undefined;
  if (kind === undefined) throw new SourceError(`${name} is ${is}.`, "Files in H5MD (.h5, .h5md) and extended XYZ (.xyz, .extxyz, .exyz) can be shown.");
  return kind;
}

/** A file in H5MD or extended XYZ, read in a worker: the page stays quick whatever the file's size. */
export class FileSource implements FrameSource {
  readonly isGrowing = false;
  readonly status = "";
  private readonly waiting = new Map<number, { resolve(value: unknown): void; reject(error: Error): void }>();
  private asked = 0;
  private known: Description | undefined;

  private constructor(readonly name: string, private readonly worker: Worker) {
    worker.onmessage = (event: MessageEvent<Answer>) => this.receive(event.data);
    worker.onerror = (event) => {
      event.preventDefault();
      const error = new SourceError(`${name} cannot be read: ${event.message || "the reader failed"}`);
      for (const { reject } of this.waiting.values()) reject(error);
      this.waiting.clear();
    };
  }

  /** `more` is known of the file from elsewhere. Rejects with SourceError for a file of another format, or a damaged one. */
  static async open(file: WorkerFile, more: Partial<Description> = {}): Promise<FileSource> {
    if (file.size === 0) throw new SourceError(`${file.name} is empty.`);
    const bytes = file.blob === undefined ? await ServedBytes.open(file.name, file.address as string) : new BlobBytes(file.name, file.blob);
    const kind = kindOfBytes(file.name, await bytes.read(0, BYTES_OF_FORMAT));
    const worker = new SourceWorker();
    const source = new FileSource(file.name, worker);
    try {
      source.known = { ...((await source.ask({ kind: "open", format: kind, file })) as Description), ...more };
      return source;
    } catch (error) {
      source.close();
      throw error;
    }
  }

  get description(): Description {
    return this.known as Description;
  }

  async refresh(): Promise<boolean> {
    return false;
  }

  async frame(index: number): Promise<SourceFrame> {
    return (await this.ask({ kind: "frame", index })) as SourceFrame;
  }

  close(): void {
    this.worker.terminate();
  }

  private ask(question: Question): Promise<unknown> {
    const number = ++this.asked;
    return new Promise((resolve, reject) => {
      this.waiting.set(number, { resolve, reject });
      this.worker.postMessage({ number, question });
    });
  }

  private receive(answer: Answer): void {
    const waiting = this.waiting.get(answer.number);
    this.waiting.delete(answer.number);
    if (answer.error === undefined) waiting?.resolve(answer.value);
    else waiting?.reject(new SourceError(answer.error.message, answer.error.hint));
  }
}
