import { beforeAll, describe, expect, it } from "vitest";

import { loadGridlock, type Gridlock, type Session } from "../../src/engine/gridlock.ts";
import { goldenRows } from "./scenes.ts";

let gridlock: Gridlock;
beforeAll(async () => {
  gridlock = await loadGridlock();
});

function runToEnd(session: Session, milliseconds?: number): void {
  while (!session.isFinished) session.advance(Number.MAX_SAFE_INTEGER, milliseconds);
}

describe("the engines as WebAssembly", () => {
  it.each(goldenRows())("give the bits of the golden table: $scene $engine", ({ toml, start, end }) => {
    const session = gridlock.open(toml);
    expect(session.stateHash()).toBe(start);
    runToEnd(session);
    expect(session.stateHash()).toBe(end);
    session.dispose();
  });

  it("give the same bits in slices of a few milliseconds", () => {
    for (const { toml, end } of goldenRows().filter(({ scene }) => ["paper", "vicsek", "jamming"].includes(scene))) {
      const session = gridlock.open(toml);
      runToEnd(session, 1);
      expect(session.stateHash()).toBe(end);
      session.dispose();
    }
  });

  it("give the same bits after going back to the start, and to a state on the road", () => {
    for (const { toml, start, end } of goldenRows()) {
      const session = gridlock.open(toml);
      const begin = session.save();
      session.advance(7, 5);
      const middle = session.save();
      const middleHash = session.stateHash();
      runToEnd(session);
      expect(session.stateHash()).toBe(end);
      session.restore(middle);
      expect(session.stateHash()).toBe(middleHash);
      runToEnd(session);
      expect(session.stateHash()).toBe(end);
      session.restore(begin);
      expect(session.stateHash()).toBe(start);
      runToEnd(session);
      expect(session.stateHash()).toBe(end);
      session.dispose();
    }
  });
});
