import { afterEach, describe, expect, it } from "vitest";

import type { EngineFrame } from "../../src/engine/engine_client.ts";
import { loadGridlock } from "../../src/engine/gridlock.ts";
import { Simulator } from "../../src/engine/simulator.ts";

/** A simulator whose page draws every frame at once. */
class Watched {
  readonly frames: EngineFrame[] = [];
  readonly failures: unknown[] = [];
  readonly simulator = new Simulator({
    frame: (frame) => {
      this.frames.push(frame);
      this.simulator.frameDrawn();
    },
    failure: (error) => this.failures.push(error),
  });

  get last(): EngineFrame {
    return this.frames.at(-1) as EngineFrame;
  }
  async until(holds: () => boolean): Promise<void> {
    while (!holds()) await new Promise((resolve) => setTimeout(resolve, 5));
  }
}

const TOML = "disks.count = 200\nrun.steps = 100000\nobserve.every = 10";

/** Each step of these disks takes longer than a slice of work. */
const LONG_STEPS =
  'disks.count = 5000\ndisks.packing_fraction = 0.6\nbox.edge = "periodic"\nengine.kind = "exact"\nengine.time_step = 1.0\nrun.steps = 50';

async function hashAt(step: number, toml = TOML): Promise<string> {
  const session = (await loadGridlock()).open(toml);
  session.advance(step);
  return session.stateHash();
}

describe("the simulator", () => {
  const watched: Watched[] = [];
  const start = (): Watched => {
    watched.push(new Watched());
    return watched.at(-1) as Watched;
  };
  afterEach(async () => {
    for (const one of watched.splice(0)) {
      await one.simulator.pause();
      expect(one.failures).toEqual([]);
    }
  });

  it("shows the start, runs, and pauses with the hash of the step that it shows", async () => {
    const one = start();
    const info = await one.simulator.open(TOML, []);
    expect(info.title).toBe("engine stepped");
    expect(one.last).toMatchObject({ step: 0, count: 200, isRunning: false, seriesBegins: true });
    one.simulator.run();
    await one.until(() => one.last.step > 500);
    expect(one.last.isRunning).toBe(true);
    await one.simulator.pause();
    expect(one.last.stateHash).toBe(await hashAt(one.last.step));
  });

  it("pauses at the end of a step, however long a step takes", async () => {
    const one = start();
    await one.simulator.open(LONG_STEPS, []);
    for (const least of [1, 3]) {
      one.simulator.run();
      await one.until(() => one.last.isRunning && one.last.step >= least);
      await one.simulator.pause();
      expect(one.last.isRunning).toBe(false);
      expect(one.last.stateHash).toBe(await hashAt(one.last.step, LONG_STEPS));
    }
    const paused = one.last.step;
    await one.simulator.rewind(1);
    expect(one.last.step).toBe(paused - 1);
    expect(one.last.stateHash).toBe(await hashAt(paused - 1, LONG_STEPS));
  });

  it("keeps to the speed that it is asked for", async () => {
    const one = start();
    await one.simulator.open(TOML, []);
    const begin = performance.now();
    one.simulator.run({ stepsPerSecond: 200 });
    await one.until(() => one.last.step >= 100);
    const seconds = (performance.now() - begin) / 1000;
    expect(one.last.step / seconds).toBeGreaterThan(50);
    expect(one.last.step / seconds).toBeLessThan(250);
  });

  it("goes back to an earlier step, and on with the same bits", async () => {
    const one = start();
    await one.simulator.open(TOML, []);
    await one.simulator.step(300);
    expect(one.last).toMatchObject({ step: 300, stateHash: await hashAt(300) });
    await one.simulator.rewind(120);
    expect(one.last).toMatchObject({ step: 180, stateHash: await hashAt(180), seriesBegins: true });
    await one.simulator.step(120);
    expect(one.last.stateHash).toBe(await hashAt(300));
    await one.simulator.restart();
    expect(one.last).toMatchObject({ step: 0, stateHash: await hashAt(0) });
    await one.simulator.rewind(10);
    expect(one.last.step).toBe(0);
  });

  it("sends every row of the series once", async () => {
    const one = start();
    const { seriesColumns } = await one.simulator.open(TOML, []);
    one.simulator.run();
    await one.until(() => one.last.step > 300);
    await one.simulator.pause();
    const steps = one.frames.flatMap((frame) => [...frame.series].filter((_, index) => index % seriesColumns.length === 0));
    expect(steps).toEqual([...steps.keys()].map((index) => 10 * index));
  });

  it("keeps the session where the next one is refused", async () => {
    const one = start();
    await one.simulator.open(TOML, []);
    await one.simulator.step(5);
    await expect(one.simulator.open("disks.count = -1", [])).rejects.toThrow("disks.count");
    expect(one.simulator.stateHash()).toBe(await hashAt(5));
  });

  it.each(["trap", "fillStack"] as const)("has a new engine for the next set-up after a %s", async (how) => {
    const one = start();
    await one.simulator.open(TOML, []);
    await one.simulator.step(5);
    const ended = how === "trap" ? /the engine has stopped: .*unreachable/ : /the engine has stopped: .*(call stack|bounds)/i;
    await expect(one.simulator.breakDown(how)).rejects.toThrow(ended);
    // What it left behind cannot be trusted.
    expect(() => one.simulator.stateHash()).toThrow("the engine has stopped");
    await expect(one.simulator.read(TOML, [])).rejects.toThrow("the engine has stopped");
    await one.simulator.open(TOML, []);
    await one.simulator.step(5);
    expect(one.last).toMatchObject({ step: 5, stateHash: await hashAt(5) });
  });

  it("stops at the end, and goes on when it is lengthened", async () => {
    const one = start();
    await one.simulator.open("disks.count = 100\nrun.steps = 40", []);
    one.simulator.run();
    await one.until(() => one.last.isFinished);
    expect(one.last).toMatchObject({ step: 40, isRunning: false });
    expect(one.last.stateHash).toHaveLength(16);
    one.simulator.lengthen();
    await one.simulator.step(3);
    expect(one.last).toMatchObject({ step: 43, isFinished: false });
  });

  it("carries out a protocol in between frames", async () => {
    const one = start();
    await one.simulator.open(
      'disks.count = 500\ndisks.start = "uniform"\nbox.edge = "periodic"\n[[protocol]]\nstage = "quench"\npacking_fraction = 0.9\n',
      [],
    );
    expect(one.last.isPrepared).toBe(false);
    one.simulator.run({ stepsPerSecond: 10 });
    await one.until(() => one.last.isFinished);
    expect(one.frames.length).toBeGreaterThan(2);
    await one.simulator.restart();
    expect(one.last.isPrepared).toBe(false);
  });
});
