/**
 * How soon the page shows its first picture, how long it draws 100,000 disks without a graphics processor, and what it does itself for a
 * frame of a million disks that a graphics processor draws, in Chromium.
 *
 *     ./dev build-web
 *     build-web/environment/bin/node web/benchmarks/page.ts        writes benchmarks/results/page.csv
 */

import { writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { join } from "node:path";

import type { Browser } from "playwright-core";

import type { RendererKind } from "../src/drawing/agent_renderer.ts";
import type { Drawing } from "../src/drawing/drawing.ts";
import { PlaygroundDriver } from "../tests/page/driver.ts";
import { openWatched, servePage, startBrowser } from "../tests/support/browser.ts";

const ROUNDS = 7;
const FRAMES = 30;

/** Seconds from the request for the page to its first picture. */
async function firstPicture(browser: Browser, address: string): Promise<number> {
  const { page } = await openWatched(browser, address);
  await page.waitForFunction(() => performance.getEntriesByName("first picture").length > 0, undefined, { polling: 10 });
  const seconds = await page.evaluate(() => performance.getEntriesByName("first picture")[0]!.startTime / 1000);
  await page.context().close();
  return seconds;
}

/** Seconds of one frame, the least of some, until `end`; not those in which the browser shows it. */
async function frame(
  browser: Browser,
  address: string,
  disks: number,
  renderer: RendererKind,
  end: keyof ReturnType<Drawing["measureFrame"]>,
): Promise<number> {
  const { page } = await openWatched(browser, `${address}?renderer=${renderer}#scene=paper`);
  const user = new PlaygroundDriver(page);
  await user.ready();
  await user.openToml(`disks.count = ${disks}\ndisks.packing_fraction = 0.7\n`);
  const shown = new RegExp(`${disks.toLocaleString("en").replaceAll(",", "\\s?")} disks`);
  await page.getByText(shown).waitFor({ timeout: 120_000 });
  await user.colourBy("displacement");
  await page.waitForTimeout(500);
  const frames = await page.evaluate((count) => {
    const { drawing } = (globalThis as unknown as { gridlock: { drawing: Drawing } }).gridlock;
    return Array.from({ length: count }, () => drawing.measureFrame());
  }, FRAMES);
  await page.context().close();
  return Math.min(...frames.map((one) => one[end])) / 1000;
}

const median = (all: number[]): number => [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)]!;

const { address, server } = await servePage();
const browser = await startBrowser();
const measurements: Record<string, () => Promise<number>> = {
  "first picture": () => firstPicture(browser, address),
  "a frame of 100000 disks": () => frame(browser, address, 100_000, "pixels", "drawn"),
  "a frame of 1000000 disks until the graphics processor has it": () => frame(browser, address, 1_000_000, "webgl", "handedOver"),
};
const times = new Map<string, number[]>();
for (let round = 0; round < ROUNDS; ++round) {
  for (const [name, measure] of Object.entries(measurements)) times.set(name, [...(times.get(name) ?? []), await measure()]);
}
await browser.close();
server.close();

const lines = [`# ${cpus()[0]!.model.trim()}; Chromium without a graphics processor; ${ROUNDS} rounds; web/benchmarks/page.ts`];
lines.push("benchmark,name,seconds_min,seconds_median");
for (const [name, all] of times) lines.push(`page,${name},${Math.min(...all).toFixed(4)},${median(all).toFixed(4)}`);
console.log(lines.join("\n"));
writeFileSync(join(import.meta.dirname, "../../benchmarks/results/page.csv"), `${lines.join("\n")}\n`);
