import { SourceError } from "./source.ts";

/** A file that is read piece by piece. */
export interface Bytes {
  readonly name: string;
  readonly size: number;
  /** Fewer bytes than asked for at the end of the file alone. Rejects with SourceError. */
  read(offset: number, length: number): Promise<Uint8Array>;
}

/** A file that the user has dropped or chosen. */
export class BlobBytes implements Bytes {
  constructor(readonly name: string, private readonly blob: Blob) {}

  get size(): number {
    return this.blob.size;
  }

  async read(offset: number, length: number): Promise<Uint8Array> {
    try {
      return new Uint8Array(await this.blob.slice(offset, offset + length).arrayBuffer());
    } catch {
      throw new SourceError(`${this.name} can no longer be read`, "Was it moved, removed or written since? Open it again.");
    }
  }
}

/** A file on the server, by requests for ranges. */
export class ServedBytes implements Bytes {
  private constructor(readonly name: string, readonly size: number, private readonly address: string) {}

  static async open(name: string, address: string): Promise<ServedBytes> {
    const answer = await request(address, { method: "HEAD" });
    return new ServedBytes(name, Number(answer.headers.get("Content-Length") ?? 0), address);
  }

  async read(offset: number, length: number): Promise<Uint8Array> {
    const end = Math.min(offset + length, this.size) - 1;
    if (end < offset) return new Uint8Array(0);
    const answer = await request(this.address, { headers: { Range: `bytes=${offset}-${end}` } });
    return new Uint8Array(await answer.arrayBuffer());
  }
}

export const NO_ANSWER = "The server does not answer.";

/** Asks the server. Rejects with SourceError, with the words of the server where it says any, and with `hint` where it says nothing. */
export async function request(address: string, options: RequestInit = {}, hint = "Is gridlock view still running?"): Promise<Response> {
  let answer: Response;
  try {
    answer = await fetch(address, options);
  } catch {
    throw new SourceError(NO_ANSWER, hint);
  }
  if (answer.ok) return answer;
  let said: { error?: string; hint?: string } = {};
  try {
    said = (await answer.json()) as { error?: string; hint?: string };
  } catch {
    // An answer without a body, as to HEAD.
  }
  throw new SourceError(said.error ?? `The server answers ${answer.status} to ${address}.`, said.hint ?? "");
}
