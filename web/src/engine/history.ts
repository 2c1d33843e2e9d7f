/** The states of a run that it can go back to. */

import type { Session } from "./gridlock.ts";

const MILLISECONDS_BETWEEN = 500;
const MOST_BYTES = 64 << 20;
const MOST_STATES = 64;

interface Saved {
  readonly step: number;
  readonly bytes: Uint8Array;
}

export class History {
  private saved: Saved[] = [];
  private last = performance.now();

  keep(session: Session): void {
    this.saved.push({ step: session.step, bytes: session.save() });
    this.last = performance.now();
  }

  /** As often as half a second of running takes. */
  isDue(session: Session): boolean {
    return performance.now() - this.last >= MILLISECONDS_BETWEEN && session.isPrepared;
  }

  /** Where there are too many, every second one is let go of, the start never. */
  keepAnother(session: Session): void {
    this.keep(session);
    const bytes = this.saved.reduce((sum, one) => sum + one.bytes.length, 0);
    if (this.saved.length > MOST_STATES || bytes > MOST_BYTES) this.saved = this.saved.filter((_, index) => index % 2 === 0);
  }

  first(): Uint8Array {
    return (this.saved[0] as Saved).bytes;
  }
  /** The latest at or before a step. */
  before(step: number): Uint8Array {
    const found = this.saved.findLast((one) => one.step <= step);
    return found?.bytes ?? this.first();
  }
  /** A run that goes on from here has other states than the ones kept. */
  forgetAfter(session: Session): void {
    this.saved = this.saved.filter((one, index) => index === 0 || one.step <= session.step);
    this.last = performance.now();
  }
}
