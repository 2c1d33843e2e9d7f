import { SourceError, type Description, type FrameSource, type SourceFrame } from "./source.ts";
import type { Answer, Question, WorkerFile } from "./source_worker.ts";
import SourceWorker from "./source_worker.ts?worker&inline";

/** By the end of its name; nothing for a file that is not shown. */
export function kindOfFile(name: string): "h5md" | "xyz" | undefined {
  const ending = name.toLowerCase().replace(/^.*\./, "");
  if (ending === "h5" || ending === "h5md" || ending === "hdf5") return "h5md";
  if (ending === "xyz" || ending === "extxyz") return "xyz";
  return undefined;
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

  /** Rejects with SourceError for a file of another format, or a damaged one. */
  static async open(file: WorkerFile): Promise<FileSource> {
    const kind = kindOfFile(file.name);
    if (kind === undefined) {
      throw new SourceError(`${file.name} is no file that can be shown here.`, "Files in H5MD (.h5) and extended XYZ (.xyz, .extxyz) can.");
    }
    if (file.size === 0) throw new SourceError(`${file.name} is empty.`);
    const worker = new SourceWorker();
    const source = new FileSource(file.name, worker);
    try {
      source.known = (await source.ask({ kind: "open", format: kind, file })) as Description;
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
