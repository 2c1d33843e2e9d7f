/** A model in Python, shown by gridlock show, in a real browser. */

import { writeFileSync } from "node:fs";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import { findings, openWatched, startBrowser } from "../support/browser.ts";
import { Workplace } from "../viewer/runs.ts";

const MODEL = `
import gridlock
import numpy as np


class Herd(gridlock.Model):
    """Sheep that walk over grass and eat it."""

    name = "herd"
    columns = {"mood": np.uint32}
    value_names = {"mood": ("hungry", "full")}
    fields = {"grass": gridlock.Field(20)}
    charts = {"Sheep by mood": ("hungry", "full")}
    count = gridlock.Setting(200, "Sheep.", least=1, most=1000)
    length = gridlock.Setting(0.01, "A step.", unit="length", least=0.0)
    breaks = gridlock.Setting(False, "Whether a step raises.")

    def start(self, start):
        start.add(positions=start.anywhere(self.count))
        start.grass[...] = 1.0

    def step(self, world):
        if self.breaks:
            raise ValueError("no grass is left")
        world.move(self.length * world.normal(2))
        world.mood[...] = (world.take("grass", 0.004) > 0) & (world.uniform(purpose=1) < 0.5)

    def observe(self, world):
        return {"hungry": np.sum(world.mood == 0), "full": np.sum(world.mood == 1), "eaten": 400 - world.grass.sum()}
`;

let place: Workplace;
let browser: Browser;
let address: string;
let page: Page;
let complaints: string[];
let foreign: string[];

beforeAll(async () => {
  place = new Workplace();
  writeFileSync(place.of("herd.py"), MODEL);
  [address, browser] = await Promise.all([place.show("herd.py", "--set", "box.edge=periodic"), startBrowser()]);
  ({ page, complaints, foreign } = await openWatched(browser, address));
}, 120_000);

afterAll(async () => {
  await browser?.close();
  await place.end();
});

const press = (name: string): Promise<void> => page.getByRole("button", { name, exact: true }).click();
const step = async (of = page): Promise<number> => Number((await of.locator(".status b").first().innerText()).replaceAll(/\D/g, ""));
const reaches = (least: number, of = page) => expect.poll(() => step(of)).toBeGreaterThanOrEqual(least);
const alert = () => page.getByRole("alert");
const number = (label: string) => page.getByRole("spinbutton", { name: label, exact: true });

/** How many different colours a canvas of the picture has in its middle. */
const colours = (at: number) => page.evaluate((at) => {
  const canvas = document.querySelectorAll<HTMLCanvasElement>(".picture canvas")[at] as HTMLCanvasElement;
  const copy = document.createElement("canvas");
  copy.width = copy.height = 200;
  const context = copy.getContext("2d") as CanvasRenderingContext2D;
  context.drawImage(canvas, canvas.width / 2 - 100, canvas.height / 2 - 100, 200, 200, 0, 0, 200, 200);
  return new Set(new Uint32Array(context.getImageData(0, 0, 200, 200).data.buffer)).size;
}, at);

test("the page shows the model at its start, with its name, its settings and its charts", async () => {
  await expect.poll(() => page.locator(".status").innerText()).toContain("200 agents");
  const setup = await page.locator(".setup").innerText();
  for (const text of ["HERD", "Sheep that walk over grass and eat it.", "Count", "Length", "Breaks"]) expect(setup).toContain(text);
  expect(await page.locator(".chart h3").allInnerTexts()).toEqual(["Sheep by mood", "Eaten"]);
  expect(await page.getByRole("combobox", { name: "Colour by" }).inputValue()).toBe("mood");
  expect(await page.getByRole("combobox", { name: "Field beneath" }).inputValue()).toBe("grass");
  expect(await findings(page)).toEqual([]);
});

test("it runs, with agents over grass that is eaten and curves in one chart, and pauses with a hash", async () => {
  await press("Run");
  await reaches(10);
  await press("Pause");
  await expect.poll(() => page.locator(".status code").innerText()).toMatch(/^[0-9a-f]{16}$/);
  await expect.poll(() => colours(0)).toBeGreaterThan(2);
  await expect.poll(() => colours(1)).toBeGreaterThan(2);
  await expect.poll(() => page.locator(".chart .keys").first().innerText()).toMatch(/hungry\s*\d+\s*full\s*\d+/);
  const before = await step();
  await press("Single step");
  await expect.poll(() => step()).toBe(before + 1);
  await press("Restart");
  await expect.poll(() => step()).toBe(0);
});

test("a slider of a setting that steps alone read holds from the next step on, and the page says when", async () => {
  await press("Single step");
  await expect.poll(() => step()).toBe(1);
  await number("Length").fill("0.02");
  await number("Length").blur();
  await expect.poll(() => page.getByRole("list", { name: "Changes of settings" }).innerText()).toBe("Step 1: Length from 0.01 to 0.02");
  expect(await step()).toBe(1);
});

test("a slider of a setting that the start reads begins anew with another number, and what is refused is said and leaves the run", async () => {
  await number("Count").fill("300");
  await number("Count").blur();
  await expect.poll(() => page.locator(".status").innerText()).toContain("300 agents");
  await number("Count").fill("0");
  await number("Count").blur();
  await expect.poll(() => alert().innerText()).toContain("herd.count is 0, but must be at least 1");
  await expect.poll(() => number("Count").inputValue()).toBe("300");
  expect(await page.locator(".status").innerText()).toContain("300 agents");
  complaints.splice(0, complaints.length, ...complaints.filter((text) => !text.includes("422"))); // the browser's own word on a refusal
});

test("a second page follows the run of the first, and a closed one is not missed", async () => {
  const other = await openWatched(browser, address);
  await press("Run");
  await reaches(5, other.page);
  await other.page.getByRole("button", { name: "Pause", exact: true }).click();
  await expect.poll(() => page.getByRole("button", { name: "Run", exact: true }).count()).toBe(1);
  await other.page.context().close();
  expect(other.complaints).toEqual([]);
  const before = await step();
  await press("Single step");
  await expect.poll(() => step()).toBe(before + 1);
});

test("a model that raises says where, and begins anew when it is mended", async () => {
  await page.getByRole("checkbox", { name: "Breaks" }).check();
  await press("Run");
  await expect.poll(() => alert().innerText()).toMatch(/the model herd raised ValueError: no grass is left \(herd\.py, line \d+\)/);
  await page.getByRole("checkbox", { name: "Breaks" }).uncheck();
  await expect.poll(() => alert().count()).toBe(0);
  await press("Run");
  await reaches(3);
});

test("a page whose program has ended says so", async () => {
  expect(complaints).toEqual([]);
  expect(foreign).toEqual([]);
  await place.end();
  await expect.poll(() => alert().innerText()).toContain("The server does not answer.");
});
