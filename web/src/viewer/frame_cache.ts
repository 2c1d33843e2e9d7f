import type { FrameSource, SourceFrame } from "../sources/source.ts";

const MOST_BYTES = 256 * 2 ** 20;

function bytesOf(frame: SourceFrame): number {
  const arrays = [...Object.values(frame.columns), ...Object.values(frame.fields ?? {}).map((field) => field.values)];
  return arrays.reduce((sum, column) => sum + column.byteLength, frame.ids.byteLength);
}

/** The frames of a source that were asked for lately, and the next one while this one is looked at. */
export class FrameCache {
  /** The oldest first. */
  private readonly kept = new Map<number, Promise<SourceFrame>>();
  private readonly bytes = new Map<number, number>();

  constructor(private readonly source: FrameSource, private readonly mostBytes = MOST_BYTES) {}

  get(index: number): Promise<SourceFrame> {
    const found = this.kept.get(index);
    if (found !== undefined) {
      this.kept.delete(index);
      this.kept.set(index, found);
      return found;
    }
    const frame = this.source.frame(index);
    this.kept.set(index, frame);
    frame.then((value) => this.weigh(index, value), () => this.forget(index));
    return frame;
  }

  /** Asks for a frame that is likely to be next; nobody waits for it. */
  prefetch(index: number): void {
    if (!this.kept.has(index)) this.get(index).catch(() => {});
  }

  /** A run that was begun again has other frames. */
  clear(): void {
    this.kept.clear();
    this.bytes.clear();
  }

  get size(): number {
    return this.kept.size;
  }

  private weigh(index: number, frame: SourceFrame): void {
    if (!this.kept.has(index)) return;
    this.bytes.set(index, bytesOf(frame));
    let sum = [...this.bytes.values()].reduce((all, one) => all + one, 0);
    for (const old of [...this.kept.keys()]) {
      // Two stay in any case: the one that is shown, and the next.
      if (sum <= this.mostBytes || this.kept.size <= 2) return;
      sum -= this.bytes.get(old) ?? 0;
      this.forget(old);
    }
  }

  private forget(index: number): void {
    this.kept.delete(index);
    this.bytes.delete(index);
  }
}
