/**
 * How soon the page shows its first picture, and how long it draws, in Chromium: 100,000 disks without a graphics processor, and what it
 * does itself for a frame of a million disks that a graphics processor draws. On a machine with a graphics processor: whole frames of
 * 100,000 and of a million disks, new ones and those of a view that moves.
 *
 *     ./dev build-web
 *     build-web/environment/bin/node web/benchmarks/page.ts                        writes benchmarks/results/page.csv
 *     build-web/environment/bin/node web/benchmarks/page.ts --graphics-processor   benchmarks/results/page_graphics_processor.csv
 *
 * GRIDLOCK_CHROMIUM names another browser than /usr/bin/chromium. --picture FILE keeps the last picture as PNG, --rounds N measures so often.
 */

import { writeFileSync } from "node:fs";
import { cpus } from "node:os";
import { join } from "node:path";
import { parseArgs } from "node:util";

import type { Browser, Page } from "playwright-core";

import type { RendererKind } from "../src/drawing/agent_renderer.ts";
import type { Drawing } from "../src/drawing/drawing.ts";
import { PlaygroundDriver } from "../tests/page/driver.ts";
import { openWatched, servePage, startBrowser } from "../tests/support/browser.ts";

const FRAMES = 30;

const { values: options } = parseArgs({
  options: {
    "graphics-processor": { type: "boolean", default: false },
    picture: { type: "string" },
    rounds: { type: "string", default: "7" },
  },
});
const onGraphicsProcessor = options["graphics-processor"];
const rounds = Number(options.rounds);

/** Seconds from the request for the page to its first picture. */
async function firstPicture(browser: Browser, address: string): Promise<number> {
  const { page } = await openWatched(browser, address);
  await page.waitForFunction(() => performance.getEntriesByName("first picture").length > 0, undefined, { polling: 10 });
  const seconds = await page.evaluate(() => performance.getEntriesByName("first picture")[0]!.startTime / 1000);
  await page.context().close();
  return seconds;
}

/** The playground with so many disks at φ = 0.7, coloured by a number of each. */
async function openDisks(browser: Browser, address: string, disks: number, renderer: RendererKind): Promise<Page> {
  const { page } = await openWatched(browser, `${address}?renderer=${renderer}#scene=paper`);
  const user = new PlaygroundDriver(page);
  await user.ready();
  await user.openToml(`disks.count = ${disks}\ndisks.packing_fraction = 0.7\n`);
  const shown = new RegExp(`${disks.toLocaleString("en").replaceAll(",", "\\s?")} disks`);
  await page.getByText(shown).waitFor({ timeout: 120_000 });
  await user.colourBy("displacement");
  await page.waitForTimeout(500);
  return page;
}

async function close(page: Page): Promise<void> {
  if (options.picture !== undefined) await page.screenshot({ path: options.picture });
  await page.context().close();
}

/** Seconds of one frame, the least of some, until `end`; not those in which the browser shows it. */
async function frame(
  browser: Browser,
  address: string,
  disks: number,
  renderer: RendererKind,
  end: keyof ReturnType<Drawing["measureFrame"]>,
): Promise<number> {
  const page = await openDisks(browser, address, disks, renderer);
  const frames = await page.evaluate((count) => {
    const { drawing } = (globalThis as unknown as { gridlock: { drawing: Drawing } }).gridlock;
    return Array.from({ length: count }, () => drawing.measureFrame());
  }, FRAMES);
  await close(page);
  return Math.min(...frames.map((one) => one[end])) / 1000;
}

/** Seconds from one frame that the browser shows to the next, the mean of some, where each has new positions. */
async function shownFrame(browser: Browser, address: string, disks: number): Promise<number> {
  const page = await openDisks(browser, address, disks, "webgl");
  const seconds = await page.evaluate(async (count) => {
    const { drawing } = (globalThis as unknown as { gridlock: { drawing: Drawing } }).gridlock;
    const nextFrame = (): Promise<number> => new Promise((resolve) => void requestAnimationFrame(resolve));
    const start = await nextFrame();
    let end = start;
    for (let i = 0; i < count; ++i) {
      drawing.drawAnew();
      end = await nextFrame();
    }
    return (end - start) / count / 1000;
  }, FRAMES);
  await close(page);
  return seconds;
}

/** What draws, in the words of the browser. */
async function rendererName(browser: Browser): Promise<string> {
  const page = await browser.newPage();
  const name = await page.evaluate(() => {
    const gl = document.createElement("canvas").getContext("webgl2");
    const names = gl?.getExtension("WEBGL_debug_renderer_info");
    return String(gl?.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
  });
  await page.close();
  return name;
}

const median = (all: number[]): number => [...all].sort((a, b) => a - b)[Math.floor(all.length / 2)]!;

const { address, server } = await servePage();
const browser = await startBrowser(onGraphicsProcessor ? "graphics processor" : "software");
const renderer = await rendererName(browser);
if (onGraphicsProcessor && /swiftshader|llvmpipe|undefined/i.test(renderer)) {
  await browser.close();
  throw new Error(`Chromium finds no graphics processor by OpenGL ES; it draws by ${renderer}`);
}

const measurements: Record<string, () => Promise<number>> = onGraphicsProcessor
  ? {
      "first picture": () => firstPicture(browser, address),
      "a frame of 100000 disks": () => frame(browser, address, 100_000, "webgl", "drawn"),
      "a frame of 1000000 disks until the graphics processor has it": () => frame(browser, address, 1_000_000, "webgl", "handedOver"),
      "a frame of 1000000 disks": () => frame(browser, address, 1_000_000, "webgl", "drawn"),
      "from one shown frame of 1000000 disks to the next": () => shownFrame(browser, address, 1_000_000),
    }
  : {
      "first picture": () => firstPicture(browser, address),
      "a frame of 100000 disks": () => frame(browser, address, 100_000, "pixels", "drawn"),
      "a frame of 1000000 disks until the graphics processor has it": () => frame(browser, address, 1_000_000, "webgl", "handedOver"),
    };
const times = new Map<string, number[]>();
for (let round = 0; round < rounds; ++round) {
  for (const [name, measure] of Object.entries(measurements)) times.set(name, [...(times.get(name) ?? []), await measure()]);
}
await browser.close();
server.close();

const machine = onGraphicsProcessor ? renderer : "without a graphics processor";
const lines = [`# ${cpus()[0]!.model.trim()}; Chromium, ${machine}; ${rounds} rounds; web/benchmarks/page.ts`];
lines.push("benchmark,name,seconds_min,seconds_median");
for (const [name, all] of times) lines.push(`page,${name},${Math.min(...all).toFixed(4)},${median(all).toFixed(4)}`);
console.log(lines.join("\n"));
const file = `${onGraphicsProcessor ? "page_graphics_processor" : "page"}.csv`;
writeFileSync(join(import.meta.dirname, "../../benchmarks/results", file), `${lines.join("\n")}\n`);
