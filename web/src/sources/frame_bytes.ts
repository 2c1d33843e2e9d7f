import type { Box, Numbers } from "../drawing/frame.ts";
import { SourceError, type SourceFrame } from "./source.ts";

interface Head {
  readonly step: number;
  readonly time: number;
  readonly box: Box;
  readonly count: number;
  readonly stateHash: string;
  readonly columns: readonly { name: string; type: string; offset: number }[];
}

const TYPES: Readonly<Record<string, new (buffer: ArrayBuffer, offset: number, length: number) => Numbers>> = {
  float64: Float64Array, float32: Float32Array, int32: Int32Array, uint32: Uint32Array, uint64: BigUint64Array,
};

/** A frame as gridlock view sends it: the length of a JSON text, the text, and the columns where it says. */
export function readFrameBytes(buffer: ArrayBuffer): SourceFrame {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))) as Head;
  const columns: Record<string, Numbers> = {};
  let ids = new Float64Array(0);
  for (const { name, type, offset } of head.columns) {
    const Type = TYPES[type];
    if (Type === undefined) throw new SourceError(`The column ${name} has numbers of an unknown type, ${type}.`);
    const values = new Type(buffer, 4 + length + offset, head.count);
    if (name === "id") ids = Float64Array.from(values as ArrayLike<number | bigint>, Number);
    else columns[name] = values;
  }
  return { step: head.step, time: head.time, box: head.box, ids, columns, stateHash: head.stateHash };
}
