/** The viewer in a real browser: runs that gridlock view serves, and files that are dropped on the static page. */

import { spawnSync } from "node:child_process";
import { existsSync, readFileSync, statSync, writeFileSync } from "node:fs";
import type { Server } from "node:http";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { File as Hdf5File, ready } from "h5wasm/node";
import type { Browser, Download, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, beforeEach, describe, expect, test, vi } from "vitest";

import { servePage, startBrowser } from "../support/browser.ts";
import { builtPage, SMALL_RUN, Workplace } from "./runs.ts";

vi.setConfig({ testTimeout: 120_000, hookTimeout: 120_000 });

let place: Workplace;
let browser: Browser;
let page: Page;
let complaints: string[];
let hosts: Set<string>;
let staticServer: Server;
let staticPage: string;

beforeAll(async () => {
  place = new Workplace();
  place.run(SMALL_RUN, "results");
  place.gridlock("export", "results", "--to", "xyz", "-o", "frames.xyz");
  place.gridlock("export", "results", "--to", "csv", "-o", "frames.csv");
  ({ address: staticPage, server: staticServer } = await servePage());
  browser = await startBrowser();
}, 120_000);
afterAll(async () => {
  await browser.close();
  staticServer.close();
  await place.end();
});

beforeEach(async () => {
  complaints = [];
  hosts = new Set();
  page = await browser.newPage({ viewport: { width: 1400, height: 900 }, acceptDownloads: true });
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => { const { protocol, hostname } = new URL(request.url()); if (protocol.startsWith("http")) hosts.add(hostname); });
});
afterEach(async () => {
  await page.close();
  expect([...hosts].filter((host) => host !== "127.0.0.1")).toEqual([]);
  expect(complaints).toEqual([]);
});

const viewerTab = (): Promise<void> => page.getByRole("tab", { name: "Viewer" }).click();
const slider = () => page.getByRole("slider", { name: "Frame", exact: true });
const status = () => page.locator(".viewer .status");
const alert = () => page.locator(".viewer").getByRole("alert");

/** Waits until the status says this. */
async function seen(text: string | RegExp, timeout = 15_000): Promise<void> {
  const end = Date.now() + timeout;
  let shown = "";
  while (Date.now() < end) {
    shown = (await status().textContent()) ?? "";
    if (typeof text === "string" ? shown.includes(text) : text.test(shown)) return;
    await page.waitForTimeout(30);
  }
  throw new Error(`the status says "${shown}", and never ${text}`);
}

async function goTo(frame: number): Promise<void> {
  await slider().fill(String(frame));
}

/** Waits until a frame is drawn: the status may name it a moment before. */
async function drawn(): Promise<void> {
  await page.waitForFunction(() => (globalThis as unknown as { gridlockViewer: { shown: unknown } }).gridlockViewer.shown !== undefined);
}

/** What an item of the menu Save gives. */
async function save(item: string): Promise<Download> {
  await drawn();
  await page.getByRole("button", { name: "Save" }).click();
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("menuitem", { name: item }).click()]);
  return download;
}

/** Where an agent is on the screen. */
async function placeOf(row: number): Promise<{ x: number; y: number }> {
  await drawn();
  const at = await page.evaluate((row) => {
    const viewer = (globalThis as unknown as { gridlockViewer: { drawing: any; shown: any } }).gridlockViewer;
    const { columns } = viewer.shown;
    const inside = viewer.drawing.camera.toPixels({ x: Number(columns.x[row]), y: Number(columns.y[row]) });
    const host = viewer.drawing.element.getBoundingClientRect();
    return { x: host.left + inside.x, y: host.top + inside.y };
  }, row);
  return at;
}

const summary = (): { state_hash: string } => JSON.parse(readFileSync(place.of("results/summary.json"), "utf8")) as { state_hash: string };

/** Cells of frames.csv of one step, in the order of the ids. */
function exported(step: number): { head: string[]; rows: string[][] } {
  const [head, ...lines] = readFileSync(place.of("frames.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
  return { head: head as string[], rows: lines.filter((cells) => Number(cells[0]) === step) };
}

describe("A finished run", () => {
  let address: string;
  beforeAll(async () => { address = await place.view("results"); });

  test("is shown at once, with its frames, its charts and the state hash of the command line", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    await seen("60 disks");
    expect(await page.locator(".viewer").textContent()).toContain("finished");
    expect(await page.locator(".viewer .chart").count()).toBeGreaterThanOrEqual(2);
    await goTo(3);
    await seen("step 60");
    await seen(summary().state_hash);
  });

  test("is played at the pace that is chosen, by the button and by keys", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    await page.getByRole("slider", { name: "Frames a second" }).fill("7");
    expect(await page.locator(".viewer .pace").textContent()).toContain("60 frames/s");
    await page.getByRole("button", { name: "Play" }).click();
    await seen("frame 4 of 4");
    await page.getByRole("button", { name: "Play" }).waitFor(); // it has stopped
    await page.locator("main").focus();
    for (const [key, frame] of [["Home", 1], [".", 2], [".", 3], [",", 2], ["End", 4]] as const) {
      await page.keyboard.press(key);
      await seen(`frame ${frame} of 4`);
    }
    await page.getByRole("slider", { name: "Frames a second" }).fill("0");
    await page.locator("main").focus();
    await page.keyboard.press(" ");
    await page.getByRole("button", { name: "Pause" }).waitFor();
    await page.keyboard.press(" ");
    await page.getByRole("button", { name: "Play" }).waitFor();
  });

  test("shows the values of agents that are clicked, and the distance between two", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    await goTo(2);
    await seen("step 40");
    const { head, rows } = exported(40);
    const click = async (row: number, modifiers: "Shift"[] = []): Promise<void> => {
      const at = await placeOf(row);
      if (modifiers.length > 0) await page.keyboard.down("Shift");
      await page.mouse.click(at.x, at.y);
      if (modifiers.length > 0) await page.keyboard.up("Shift");
    };
    await click(7);
    const line = (name: string): Promise<(string | null)[]> => page.locator(".agents tr", { has: page.getByRole("rowheader", { name, exact: true }) }).locator("td").allTextContents();
    for (const name of ["x", "velocity_y", "radius"]) {
      const value = Number((rows[7] as string[])[head.indexOf(name)]);
      expect(await line(name.replaceAll("_", " ")), name).toEqual([String(Number(value.toPrecision(8)))]);
    }
    await click(30, ["Shift"]);
    const at = (row: number, name: string): number => Number((rows[row] as string[])[head.indexOf(name)]);
    const along = (name: string): number => { const d = at(30, name) - at(7, name); return d - Math.round(d); };
    const expected = Math.hypot(along("x"), along("y"));
    const said = await page.getByText("Distance between centres").textContent();
    expect(Number(said?.split(": ")[1])).toBeCloseTo(expected, 5);
    await goTo(3);
    await seen("step 60");
    const later = exported(60);
    expect((await line("x"))[0]).toBe(String(Number(Number((later.rows[7] as string[])[later.head.indexOf("x")]).toPrecision(8))));
    await page.getByLabel("Id of an agent to select").fill("12");
    await page.keyboard.press("Enter");
    expect(await page.locator(".agents th[scope=col]").allTextContents()).toEqual(["id", "12"]);
  });

  test("measures from agent to agent", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    await page.evaluate(() => {
      const { gridlockViewer } = globalThis as unknown as { gridlockViewer: { drawing: { onMeasure: (length: number) => void } } };
      gridlockViewer.drawing.onMeasure = (length) => { Object.assign(globalThis, { measured: length }); };
    });
    await page.getByRole("button", { name: "Measure" }).click();
    const [from, to] = [await placeOf(3), await placeOf(4)];
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move((from.x + to.x) / 2, (from.y + to.y) / 2);
    await page.mouse.move(to.x, to.y);
    await page.mouse.up();
    const { head, rows } = exported(0);
    const along = (name: string): number => {
      const [a, b] = [3, 4].map((row) => Number((rows[row] as string[])[head.indexOf(name)])) as [number, number];
      return b - a - Math.round(b - a);
    };
    const measured = await page.evaluate(() => (globalThis as unknown as { measured: number }).measured);
    expect(measured).toBeCloseTo(Math.hypot(along("x"), along("y")), 5);
  });

  test("is coloured by every choice", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    await goTo(3);
    await seen("step 60");
    const colour = page.getByRole("combobox", { name: "Colour by" });
    const choices = await colour.locator("option").evaluateAll((options) => options.map((one) => (one as HTMLOptionElement).value));
    expect(choices).toContain("displacement");
    const pictures = new Set<string>();
    for (const choice of choices) {
      await colour.selectOption(choice);
      await page.waitForTimeout(100);
      pictures.add((await page.locator(".viewer .picture").screenshot()).toString("base64"));
      expect(await alert().isVisible()).toBe(false);
    }
    expect(pictures.size).toBeGreaterThan(choices.length / 2);
  });

  test("has |ψ6| as the program averages it, and the grid in which neighbours are searched", async () => {
    place.run(`${SMALL_RUN}observe.structure_every = 1\n`, "ordered");
    await page.goto(await place.view("ordered"));
    await seen("frame 1 of 4");
    await goTo(3);
    await seen("step 60");
    await page.evaluate(() => {
      const { drawing } = (globalThis as unknown as { gridlockViewer: any }).gridlockViewer;
      const show = drawing.show.bind(drawing);
      drawing.show = (frame: unknown, colouring: { values: Float32Array }) => {
        Object.assign(globalThis, { shownValues: colouring.values });
        show(frame, colouring);
      };
    });
    await page.locator(".viewer").getByRole("combobox", { name: "Colour by" }).selectOption("psi6");
    const mean = await page.evaluate(() => {
      const values = (globalThis as unknown as { shownValues: Float32Array }).shownValues;
      return values.reduce((sum, value) => sum + value, 0) / values.length;
    });
    const [head, ...rows] = readFileSync(place.of("ordered/series.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
    const last = rows.find((cells) => cells[0] === "60") as string[];
    expect(mean).toBeCloseTo(Number(last[(head as string[]).indexOf("local_bond_orientation_order")]), 5);
    const before = await page.locator(".viewer .picture").screenshot();
    await page.getByRole("checkbox", { name: "Grid of k × k cells" }).check();
    expect((await page.locator(".viewer .picture").screenshot()).equals(before)).toBe(false);
    await page.locator("main").focus();
    await page.keyboard.press("g");
    expect(await page.getByRole("checkbox", { name: "Grid of k × k cells" }).isChecked()).toBe(false);
  });

  test("is saved as PNG, SVG and a video", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    const saved = async (item: string): Promise<{ name: string; bytes: Buffer }> => {
      const file = await save(item);
      return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()) };
    };
    const png = await saved("Picture, PNG");
    expect(png.name).toBe("results_0.png");
    expect(png.bytes.subarray(1, 4).toString()).toBe("PNG");
    const svg = await saved("Picture, SVG");
    expect(svg.name).toBe("results_0.svg");
    expect(svg.bytes.toString()).toMatch(/^<svg /);
    const video = await saved("Video to the last frame");
    expect(video.name).toMatch(/^results\.(webm|mp4)$/);
    expect(video.bytes.length).toBeGreaterThan(1000);
    if (video.name.endsWith("webm")) expect(video.bytes.subarray(0, 4).toString("hex")).toBe("1a45dfa3");
    if (spawnSync("ffprobe", ["-version"]).status === 0) {
      writeFileSync(place.of(video.name), video.bytes);
      const probe = spawnSync("ffprobe", ["-v", "error", "-select_streams", "v:0", "-show_entries", "stream=codec_type", "-of", "csv=p=0", place.of(video.name)], { encoding: "utf8" });
      expect(probe.stdout.trim()).toBe("video");
    }
    await seen("frame 4 of 4");
  });

  test("has no serious finding of axe-core, light or dark", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    const at = await placeOf(5);
    await page.mouse.click(at.x, at.y);
    await page.addScriptTag({ path: createRequire(import.meta.url).resolve("axe-core/axe.min.js") }).catch(() => {});
    await page.evaluate(readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"));
    complaints = complaints.filter((text) => !text.includes("Content Security Policy")); // of the script that this test adds
    for (const theme of ["light", "dark"]) {
      if (theme === "dark") {
        await page.getByRole("button", { name: "Light or dark" }).click();
        await page.waitForTimeout(500); // colours change little by little
      }
      const found = await page.evaluate(async () => {
        const { axe } = globalThis as unknown as { axe: { run(): Promise<{ violations: { id: string; impact: string; nodes: { html: string }[] }[] }> } };
        return (await axe.run()).violations.filter((one) => one.impact === "serious" || one.impact === "critical").map((one) => `${one.id}: ${one.nodes[0]?.html}`);
      });
      expect(found, theme).toEqual([]);
    }
  });

  test("is beside the playground, whose engines run there too", async () => {
    await page.goto(address);
    await seen("frame 1 of 4");
    await page.getByRole("tab", { name: "Playground" }).click();
    await expect.poll(() => page.locator(".playground:not(.viewer) .status code").textContent(), { timeout: 60_000 }).toMatch(/^[0-9a-f]{16}$/);
    await viewerTab();
    await seen("frame 1 of 4");
  });

  test("says so when the server has gone", async () => {
    const other = new Workplace();
    other.run(SMALL_RUN, "results");
    const lost = await other.view("results");
    await page.goto(lost);
    await seen("frame 1 of 4");
    await other.end();
    await goTo(3);
    await expect.poll(() => alert().textContent()).toContain("The server does not answer.");
    complaints = complaints.filter((text) => !text.includes("ERR_CONNECTION"));
  });
});

describe("A run with walls inside the box", () => {
  test("shows them, also where it has kept its last state alone", async () => {
    const walls = 'walls = [{ from = [0.0, 0.0], to = [0.01, 0.01] }]\n';
    const settings = `${walls}${SMALL_RUN.replace('"periodic"', '"wall"')}engine.kind = "exact"\n`;
    place.run(settings, "walled");
    place.run(settings.replace(/trajectory.*\n/, ""), "walled_end");
    for (const [path, count] of [["walled", 1], ["walled/trajectory.h5", 1], ["walled_end", 1], ["walled_end/final.xyz", 0], ["results", 0]] as const) {
      await page.goto(await place.view(path));
      await seen("frame 1 of");
      const svg = readFileSync(await (await save("Picture, SVG")).path(), "utf8");
      expect(svg.match(/stroke-width="2"/g)?.length ?? 0, path).toBe(count);
    }
  });
});

describe("A packing", () => {
  test("shows its stages, charts against φ and results, as the program has written them", async () => {
    const toml = `disks.count = 36
disks.packing_fraction = 0.4
disks.start = "random"
velocities.kind = "maxwell"
box = { edge = "periodic", width = 1.5, height = 0.8 }
[[protocol]]
stage = "grow"
until_packing_fraction = 0.6
[[protocol]]
stage = "quench"
packing_fraction = 0.9
[[protocol]]
stage = "decompress"
until_pressure = 1e-4
`;
    place.run(toml, "packing");
    await page.goto(await place.view("packing"));
    const side = page.locator(".viewer").getByRole("complementary", { name: "Charts" });
    await side.getByText("Jamming at φJ").waitFor();
    expect(await side.locator(".chart:visible h3").allInnerTexts()).toEqual(["Pressure of soft disks", "Contact number", "Elastic moduli, stage 3 decompress"]);
    expect(await side.getByRole("rowheader").allInnerTexts()).toEqual(["1 grow", "2 quench", "3 decompress"]);
    expect(await side.getByRole("row", { name: "1 grow" }).innerText()).toContain("Z = ");
    const { jamming_packing_fraction: jamming } = JSON.parse(readFileSync(place.of("packing/summary.json"), "utf8")) as Record<string, { value: number }>;
    const said = await side.locator("dt", { hasText: "Jamming at φJ" }).locator("+ dd").innerText();
    expect(Number(said.split(" ")[0])).toBeCloseTo((jamming as { value: number }).value, 4);
    expect(await side.getByText("There are no quantities against time").isVisible()).toBe(false);
  });

  test("that was sheared shows its stress against the strain, and its last state in an oblique box", async () => {
    place.run(readFileSync(join(import.meta.dirname, "../../../scenes/shear.toml"), "utf8"), "sheared");
    await page.goto(await place.view("sheared"));
    const side = page.locator(".viewer").getByRole("complementary", { name: "Charts" });
    await side.getByText("First at γ").waitFor();
    expect((await side.locator(".chart:visible h3").allInnerTexts()).slice(0, 2)).toEqual(["Stress against strain", "Pressure under shear"]);
    const { shear_stress: stress } = JSON.parse(readFileSync(place.of("sheared/summary.json"), "utf8")) as Record<string, { value: number }>;
    const said = await side.getByRole("figure", { name: /^Stress against strain: / }).getAttribute("aria-label");
    expect(Number(said?.split(" ").at(-1))).toBeCloseTo((stress as { value: number }).value, 6);
    const box = await page.evaluate(() =>
      (globalThis as unknown as { gridlockViewer: { drawing: { frame: { box: unknown } } } }).gridlockViewer.drawing.frame.box);
    expect(box).toEqual({ width: 1, height: 1, periodic: true, shift: 0.2 });
  });
});

describe("A run that is written", () => {
  test("is followed to its newest frame, until one looks back; also after a kill and a resume", async () => {
    writeFileSync(place.of("long.toml"), "disks.count = 400\ndisks.packing_fraction = 0.5\nrun.steps = 100000000\nobserve.every = 1000\ntrajectory.every = 4000\n");
    const run = place.begin(["run", "long.toml", "-o", "long", "-q", "--no-pictures"]);
    await expect.poll(() => existsSync(place.of("long/trajectory.h5")), { timeout: 20_000 }).toBe(true);
    await page.goto(await place.view("long"));
    await seen(/frame (\d[\d\u2009]*) of \1step/);
    expect(await page.locator(".viewer").textContent()).toContain("being written");
    const count = async (): Promise<number> => Number(await slider().getAttribute("max")) + 1;
    const first = await count();
    await expect.poll(count, { timeout: 20_000 }).toBeGreaterThan(first + 1);
    await seen(/frame (\d[\d\u2009]*) of \1step/);
    await goTo(0);
    await seen("step 0");
    const then = await count();
    await expect.poll(count, { timeout: 20_000 }).toBeGreaterThan(then);
    await seen("frame 1 of");
    expect(await page.getByLabel("Follow the run").isChecked()).toBe(false);
    await page.getByLabel("Follow the run").check();
    await seen(/frame (\d[\d\u2009]*) of \1step/);
    const ended = new Promise((resolve) => run.once("exit", resolve));
    run.kill("SIGKILL");
    await ended;
    await page.waitForTimeout(1500);
    const atKill = await count();
    await seen(/frame (\d[\d\u2009]*) of \1step/);
    expect(await alert().isVisible()).toBe(false);
    const resumed = place.begin(["resume", "long", "-q"]);
    await expect.poll(count, { timeout: 30_000 }).toBeGreaterThan(atKill + 1);
    const stopped = new Promise((resolve) => resumed.once("exit", resolve));
    resumed.kill("SIGTERM");
    await stopped;
    await expect.poll(() => page.locator(".viewer").textContent(), { timeout: 20_000 }).toContain("interrupted");
    expect(await alert().isVisible()).toBe(false);
  }, 120_000);
});

describe("A run whose series.csv is damaged", () => {
  test("says what is wrong with the file, and shows the rest", async () => {
    place.run(SMALL_RUN, "damaged");
    const series = place.of("damaged/series.csv");
    writeFileSync(series, readFileSync(series, "utf8").replace("\n10,", "\n10,what"));
    await page.goto(await place.view("damaged"));
    await seen("frame 1 of 4");
    await page.getByText(/series\.csv cannot be read: “what.*” in line 3, column time, is not a number/).waitFor();
    await expect.poll(() => page.locator(".viewer .chart").count()).toBeGreaterThan(0);
  });
});

describe("A sweep", () => {
  test("lists its runs, and shows the one that is chosen", async () => {
    writeFileSync(place.of("sweep.toml"), `${SMALL_RUN}[sweep]\n"disks.packing_fraction" = [0.2, 0.6]\n`);
    place.gridlock("sweep", "sweep.toml", "-o", "sweep", "-q", "--no-pictures");
    await page.goto(await place.view("sweep"));
    await seen("frame 1 of 4");
    const runs = page.getByRole("combobox", { name: "Run of the sweep" });
    const names = await runs.locator("option").evaluateAll((options) => options.map((one) => (one as HTMLOptionElement).value));
    expect(names.length).toBe(2);
    expect(await runs.locator("option").allInnerTexts()).toEqual(["φ = 0.2", "φ = 0.6"]);
    for (const name of names) {
      if ((await runs.inputValue()) !== name) await runs.selectOption(name);
      await expect.poll(() => page.locator(".viewer .setup p").first().textContent()).toBe(name.replace("packing_fraction=", "φ = "));
      // A run that has just been chosen begins at its first frame, whatever was shown before.
      await seen("frame 1 of 4");
      await goTo(3);
      const { state_hash } = JSON.parse(readFileSync(place.of(`sweep/runs/${name}/summary.json`), "utf8")) as { state_hash: string };
      await seen(state_hash);
    }
  });
});

describe("A file on the static page", () => {
  const choose = (path: string): Promise<void> => page.locator(".viewer input[type=file]").setInputFiles(path);
  const drop = async (path: string, name: string): Promise<void> => {
    const transfer = await page.evaluateHandle(({ bytes, name }) => {
      const made = new DataTransfer();
      made.items.add(new File([Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0))], name));
      return made;
    }, { bytes: readFileSync(path).toString("base64"), name });
    await page.dispatchEvent("body", "dragover", { dataTransfer: transfer });
    await page.dispatchEvent("body", "drop", { dataTransfer: transfer });
  };

  test("in H5MD is shown where it is dropped, with every bit", async () => {
    await page.goto(staticPage);
    await drop(place.of("results/trajectory.h5"), "trajectory.h5");
    await seen("frame 1 of 4");
    await goTo(3);
    await seen(summary().state_hash);
    expect(await page.locator(".viewer .chart").count()).toBeGreaterThanOrEqual(2);
  });

  test("of a model with fields has one beneath its agents, or none", async () => {
    await ready;
    const file = new Hdf5File(place.of("fields.h5"), "w");
    for (const group of ["particles", "particles/all", "particles/all/position", "fields", "fields/grass"]) file.create_group(group);
    file.create_dataset({ name: "particles/all/position/value", data: new Float64Array([0, 0, 1, 1]), shape: [1, 2, 2] });
    file.create_dataset({ name: "fields/grass/value", data: new Float64Array([0, 1, 2, 3]), shape: [1, 2, 2] });
    file.close();
    await page.goto(staticPage);
    await viewerTab();
    await choose(place.of("fields.h5"));
    const chosen = page.getByRole("combobox", { name: "Field beneath" });
    const canvases = page.locator(".viewer .picture canvas");
    await expect.poll(() => canvases.count()).toBe(3);
    const upperRight = await canvases.first().evaluate((canvas: HTMLCanvasElement) => {
      const context = canvas.getContext("2d") as CanvasRenderingContext2D;
      return [...context.getImageData(0.6 * canvas.width, 0.3 * canvas.height, 1, 1).data];
    });
    expect(upperRight).toEqual([0, 105, 56, 255]);
    await chosen.selectOption("");
    await expect.poll(() => canvases.first().isVisible()).toBe(false);
  });

  test("is shown by the page that is one file on a disk", async () => {
    await page.goto(pathToFileURL(join(builtPage(), "playground.html")).href);
    await viewerTab();
    await choose(place.of("results/trajectory.h5"));
    await seen("frame 1 of 4");
    await goTo(3);
    await seen(summary().state_hash);
    expect([...hosts]).toEqual([]);
  });

  test("in extended XYZ is shown too", async () => {
    await page.goto(staticPage);
    await viewerTab();
    await choose(place.of("frames.xyz"));
    await seen("frame 1 of 4");
    await goTo(3);
    await seen("step 60");
    expect(await page.locator(".viewer").textContent()).toContain("no quantities against time");
  });

  test("that is damaged gets a sentence, and the next one is shown", async () => {
    await page.goto(staticPage);
    await viewerTab();
    const bytes = readFileSync(place.of("results/trajectory.h5"));
    const cases: readonly [string, Buffer | string, string][] = [
      ["cut.h5", bytes.subarray(0, statSync(place.of("results/trajectory.h5")).size / 2), "cut.h5 is cut off: "],
      ["text.h5", "this is no HDF5", "text.h5 is no HDF5 file."],
      ["empty.h5", "", "empty.h5 is empty."],
      ["damaged.xyz", "2\ncomment\nA 1 2 0\nA 1 zwei 0\n", 'damaged.xyz, line 4: the y position is "zwei", but must be a finite number.'],
      ["picture.png", "\u0089PNG", "picture.png is no file that can be shown here."],
    ];
    for (const [name, content, message] of cases) {
      writeFileSync(place.of(name), content);
      await choose(place.of(name));
      await expect.poll(() => alert().textContent(), { timeout: 15_000 }).toContain(message);
    }
    await choose(place.of("results/trajectory.h5"));
    await seen("frame 1 of 4");
    expect(await alert().isVisible()).toBe(false);
  });
});

describe("A file that is served", () => {
  test("of another program in H5MD is read by requests for ranges", async () => {
    await ready;
    const file = new Hdf5File(place.of("foreign.h5"), "w");
    for (const group of ["particles", "particles/all", "particles/all/box", "particles/all/position"]) file.create_group(group);
    file.create_dataset({ name: "particles/all/position/value", data: new Float64Array([0.5, 0.5, 0, 1, 1, 0, 0.75, 0.5, 0, 1.5, 1, 0]), shape: [2, 2, 3] });
    file.create_dataset({ name: "particles/all/box/edges", data: new Float64Array([2, 2, 1]) });
    file.close();
    await page.goto(await place.view("foreign.h5"));
    await seen("frame 1 of 2");
    await seen("2 all");
    complaints = complaints.filter((text) => !text.includes("422")); // the library's reader refuses it first
  });

  test("in extended XYZ is shown", async () => {
    await page.goto(await place.view("results/final.xyz"));
    await seen("frame 1 of 1");
    await seen("step 60");
  });
});
