import type { Bytes } from "./bytes.ts";
import { SourceError } from "./source.ts";

const SIGNATURE = [0x89, 0x48, 0x44, 0x46, 0x0d, 0x0a, 0x1a, 0x0a];
const WRITER = 0b101; // open for writing, open for writing beside readers

/**
 * What the first bytes of an HDF5 file say: whether a writer has it open, or was killed. Rejects with SourceError for what is no HDF5
 * file, and for a file that is shorter than it says: HDF5 itself looks for the rest again and again.
 * Source: HDF5 file format specification, version 3, II.A.
 */
export async function readHead(bytes: Bytes): Promise<{ hasWriter: boolean }> {
  const head = await bytes.read(0, 96);
  if (head.length < 48 || SIGNATURE.some((byte, at) => head[at] !== byte)) {
    throw new SourceError(`${bytes.name} is no HDF5 file.`, "Trajectories of Gridlock are HDF5 files with the ending .h5.");
  }
  const version = head[8] as number;
  const end = endOfFile(head, version);
  if (end !== undefined && end > BigInt(bytes.size)) {
    throw new SourceError(`${bytes.name} is cut off: ${bytes.size} of its ${end} bytes are there.`, "Copy the whole file; gridlock view shows the frames that such a file still has.");
  }
  return { hasWriter: version === 3 && ((head[11] as number) & WRITER) !== 0 };
}

/** The end of the file, an address of 8 bytes at a place that depends on the version; nothing where the file has others. */
function endOfFile(head: Uint8Array, version: number): bigint | undefined {
  const isOld = version < 2;
  if (head[isOld ? 13 : 9] !== 8) return undefined;
  const place = isOld ? (version === 0 ? 24 : 28) + 16 : 12 + 16;
  return new DataView(head.buffer, head.byteOffset).getBigUint64(place, true);
}
