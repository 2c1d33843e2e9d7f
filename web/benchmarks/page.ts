/**
 * How soon the page shows its first picture, and how long it draws 100,000 disks without a graphics processor, in Chromium.
 *
 *     ./dev build-web
 *     build-web/environment/bin/node web/benchmarks/page.ts        writes benchmarks/results/page.csv
 */

import { writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { join } from "node:path";

import type { Browser } from "playwright-core";

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

/** Seconds of the work of one frame; not those in which the browser shows it. */
async function frame(browser: Browser, address: string): Promise<number> {
  const { page } = await openWatched(browser, `${address}#scene=paper`);
  const user = new PlaygroundDriver(page);
  await user.ready();
  await user.openToml("disks.count = 100_000\ndisks.packing_fraction = 0.7\n");
  await page.getByText(/100\s?000 disks/).waitFor({ timeout: 30_000 });
  await user.colourBy("displacement");
  await page.waitForTimeout(500);
  const milliseconds = await page.evaluate((frames) => {
    const { drawing } = (globalThis as unknown as { gridlock: { drawing: { measureFrame(frames: number): number } } }).gridlock;
    return Math.min(...Array.from({ length: frames }, () => drawing.measureFrame(1)));
  }, FRAMES);
  await page.context().close();
  return milliseconds / 1000;
}

const median = (all: number[]): number => [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)]!;

const { address, server } = await servePage();
const browser = await startBrowser();
const times: Record<string, number[]> = { "first picture": [], "a frame of 100000 disks": [] };
for (let round = 0; round < ROUNDS; ++round) {
  times["first picture"]!.push(await firstPicture(browser, address));
  times["a frame of 100000 disks"]!.push(await frame(browser, address));
}
await browser.close();
server.close();

const lines = [`# ${cpus()[0]!.model.trim()}; Chromium without a graphics processor; ${ROUNDS} rounds; web/benchmarks/page.ts`];
lines.push("benchmark,name,seconds_min,seconds_median");
for (const [name, all] of Object.entries(times)) lines.push(`page,${name},${Math.min(...all).toFixed(4)},${median(all).toFixed(4)}`);
console.log(lines.join("\n"));
writeFileSync(join(import.meta.dirname, "../../benchmarks/results/page.csv"), `${lines.join("\n")}\n`);
