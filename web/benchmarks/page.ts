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

import { PlaygroundDriver } from "../tests/page/driver.ts";
import { openWatched, servePage, startBrowser } from "../tests/support/browser.ts";

const ROUNDS = 7;
const FRAMES = 10;

/** Seconds from the request for the page to its first picture. */
async function firstPicture(browser: Browser, address: string): Promise<number> {
  const { page } = await openWatched(browser, address);
  await page.waitForFunction(() => performance.getEntriesByName("first picture").length > 0, undefined, { polling: 10 });
  const seconds = await page.evaluate(() => performance.getEntriesByName("first picture")[0]!.startTime / 1000);
  await page.context().close();
  return seconds;
}

interface Measured {
  handedOver: number;
  drawn: number;
}

/** Seconds of one frame, the least of some: until the page has handed it over, and until it is drawn; not those in which the browser shows it. */
async function frame(browser: Browser, address: string, disks: number, renderer: string): Promise<Measured> {
  const { page } = await openWatched(browser, `${address}?renderer=${renderer}#scene=paper`);
  const user = new PlaygroundDriver(page);
  await user.ready();
  await user.openToml(`disks.count = ${disks}\ndisks.packing_fraction = 0.7\n`);
  const shown = new RegExp(`${disks.toLocaleString("en").replaceAll(",", "\\s?")} disks`);
  await page.getByText(shown).waitFor({ timeout: 120_000 });
  await user.colourBy("displacement");
  await page.waitForTimeout(500);
  const milliseconds = await page.evaluate((frames) => {
    const { drawing } = (globalThis as unknown as { gridlock: { drawing: { measureFrame(): Measured } } }).gridlock;
    const all = Array.from({ length: frames }, () => drawing.measureFrame());
    return { handedOver: Math.min(...all.map((one) => one.handedOver)), drawn: Math.min(...all.map((one) => one.drawn)) };
  }, FRAMES);
  await page.context().close();
  return { handedOver: milliseconds.handedOver / 1000, drawn: milliseconds.drawn / 1000 };
}

const median = (all: number[]): number => [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)]!;

const { address, server } = await servePage();
const browser = await startBrowser();
const times: Record<string, number[]> = {
  "first picture": [],
  "a frame of 100000 disks": [],
  "a frame of 1000000 disks until the graphics processor has it": [],
};
for (let round = 0; round < ROUNDS; ++round) {
  times["first picture"]!.push(await firstPicture(browser, address));
  times["a frame of 100000 disks"]!.push((await frame(browser, address, 100_000, "pixels")).drawn);
  times["a frame of 1000000 disks until the graphics processor has it"]!.push((await frame(browser, address, 1_000_000, "webgl")).handedOver);
}
await browser.close();
server.close();

const lines = [`# ${cpus()[0]!.model.trim()}; Chromium without a graphics processor; ${ROUNDS} rounds; web/benchmarks/page.ts`];
lines.push("benchmark,name,seconds_min,seconds_median");
for (const [name, all] of Object.entries(times)) lines.push(`page,${name},${Math.min(...all).toFixed(4)},${median(all).toFixed(4)}`);
console.log(lines.join("\n"));
writeFileSync(join(import.meta.dirname, "../../benchmarks/results/page.csv"), `${lines.join("\n")}\n`);
