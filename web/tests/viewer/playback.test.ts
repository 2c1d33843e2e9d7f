import { describe, expect, test } from "vitest";

import type { FrameSource, SourceFrame } from "../../src/sources/source.ts";
import { FrameCache } from "../../src/viewer/frame_cache.ts";
import { Playback } from "../../src/viewer/playback.ts";

/** A playback without delays, and the frames that it has shown. */
function playing(show: (index: number) => Promise<void> = async () => {}): { playback: Playback; shown: number[] } {
  const shown: number[] = [];
  const playback = new Playback(async (index) => { shown.push(index); await show(index); }, () => {}, () => new Promise((resolve) => setTimeout(resolve)));
  return { playback, shown };
}

describe("Playback", () => {
  test("shows every frame once, and stops at the last", async () => {
    const { playback, shown } = playing();
    await playback.reset(5, false);
    await playback.play();
    expect(shown).toEqual([0, 1, 2, 3, 4]);
    expect(playback.isPlaying).toBe(false);
  });

  test("begins anew where it is at the end", async () => {
    const { playback, shown } = playing();
    await playback.reset(3, false);
    await playback.choose(2);
    await playback.play();
    expect(shown).toEqual([0, 2, 0, 1, 2]);
  });

  test("of wishes that come while a frame is read fulfils the last alone", async () => {
    let release = (): void => {};
    const { playback, shown } = playing((index) => (index === 1 ? new Promise((resolve) => { release = resolve; }) : Promise.resolve()));
    await playback.reset(100, false);
    const first = playback.choose(1);
    for (const index of [10, 20, 30]) void playback.choose(index);
    release();
    await first;
    expect(shown).toEqual([0, 1, 30]);
  });

  test("follows a run until the user looks back, and again from the last frame", async () => {
    const { playback, shown } = playing();
    await playback.reset(2, true);
    await playback.setCount(5);
    expect(shown).toEqual([1, 4]);
    await playback.choose(1);
    expect(playback.isFollowing).toBe(false);
    await playback.setCount(9);
    expect(playback.index).toBe(1);
    await playback.setFollowing(true);
    expect(playback.index).toBe(8);
    await playback.choose(8);
    expect(playback.isFollowing).toBe(true);
  });

  test("stays within the frames that there are", async () => {
    const { playback } = playing();
    await playback.reset(3, false);
    await playback.choose(-5);
    expect(playback.index).toBe(0);
    await playback.choose(99);
    expect(playback.index).toBe(2);
    await playback.setCount(1); // the run was begun again
    expect(playback.index).toBe(0);
    await playback.reset(0, true);
    await playback.play();
    expect(playback.index).toBe(0);
  });
});

describe("The cache of frames", () => {
  const frameOf = (index: number): SourceFrame => ({
    step: index, time: index, box: { width: 1, height: 1, periodic: true }, ids: new Float64Array(100), columns: { x: new Float64Array(100) }, stateHash: "",
  });
  const source = (frame: (index: number) => Promise<SourceFrame>): FrameSource => ({ frame }) as unknown as FrameSource;

  test("asks once for a frame, and lets the oldest go where there are too many bytes", async () => {
    const asked: number[] = [];
    const cache = new FrameCache(source(async (index) => { asked.push(index); return frameOf(index); }), 5 * 1600);
    for (let index = 0; index < 10; ++index) await cache.get(index);
    await cache.get(9);
    expect(asked.length).toBe(10);
    expect(cache.size).toBeLessThanOrEqual(5);
    await cache.get(0);
    expect(asked.length).toBe(11);
  });

  test("asks again for a frame that could not be read", async () => {
    let failures = 1;
    const cache = new FrameCache(source(async (index) => { if (failures-- > 0) throw new Error("no answer"); return frameOf(index); }));
    await expect(cache.get(3)).rejects.toThrow("no answer");
    expect((await cache.get(3)).step).toBe(3);
  });
});
