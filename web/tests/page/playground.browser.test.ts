import type { Server } from "node:http";

import type { Browser } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { SCENES } from "../../src/playground/scenes.ts";
import { goldenRows } from "../engine/scenes.ts";
import { openWatched, servePage, startBrowser, type Watched } from "../support/browser.ts";
import { PlaygroundDriver } from "./driver.ts";

let browser: Browser;
let server: Server;
let address: string;

beforeAll(async () => {
  ({ address, server } = await servePage());
  browser = await startBrowser();
});

afterAll(async () => {
  await browser?.close();
  server?.close();
});

interface Opened extends Watched {
  readonly user: PlaygroundDriver;
}

/** The page, ready for use; at the end nothing must have been complained about. */
async function withPlayground(
  hash: string,
  use: (opened: Opened) => Promise<void>,
  options: Parameters<typeof openWatched>[2] = {},
): Promise<void> {
  const watched = await openWatched(browser, address + hash, options);
  const user = new PlaygroundDriver(watched.page);
  try {
    await user.ready();
    await use({ ...watched, user });
    expect(watched.complaints).toEqual([]);
    expect(watched.foreign).toEqual([]);
  } finally {
    await watched.page.context().close();
  }
}

describe("every scene", () => {
  for (const scene of SCENES) {
    test(`${scene.name} opens, runs and is drawn`, { timeout: 120_000 }, async () => {
      await withPlayground(`#scene=${scene.name}`, async ({ page, user }) => {
        expect(await page.getByRole("combobox", { name: "Scene" }).inputValue()).toBe(scene.name);
        const isPacking = ["jamming", "shear", "shear_stable"].includes(scene.name);
        const before = await user.hash();
        if (isPacking) {
          await user.press("Run");
          await page.getByRole("button", { name: /Continue|Run/ }).waitFor({ timeout: 90_000 });
          await page.waitForFunction((start) => document.querySelector(".status code")?.textContent !== start, before, {
            timeout: 90_000,
          });
        } else {
          await user.runPast(2);
          expect(await user.step()).toBeGreaterThan(2);
        }
        expect(await user.hash()).not.toBe(before);
        expect(await user.coloursInPicture()).toBeGreaterThan(1);
        expect(await page.locator(".chart").count()).toBeGreaterThan(0);
      });
    });
  }
});

describe("the state hash is that of the golden table", () => {
  const NAMES = [
    "paper stepped",
    "paper tiled",
    "paper exact",
    "triangular exact",
    "mixture exact",
    "rectangle stepped",
    "gas tiled",
    "few exact",
  ];
  const OF_MODELS = ["vicsek flocking", "boids flocking", "walls epidemic", "every_event catalyst", "jamming protocol"];
  const rows = goldenRows().filter((row) => [...NAMES, ...OF_MODELS].includes(`${row.scene} ${row.engine}`));

  test("there are more than ten", () => {
    expect(rows.length).toBe(NAMES.length + OF_MODELS.length);
  });

  for (const row of rows) {
    test(`${row.scene} ${row.engine}`, { timeout: 120_000 }, async () => {
      await withPlayground("#speed=100000", async ({ page, user }) => {
        await user.openToml(row.toml);
        await page.waitForFunction((hash) => document.querySelector(".status code")?.textContent === hash, row.start);
        await user.press("Run");
        await page.getByText("finished", { exact: true }).waitFor({ timeout: 90_000 });
        expect(await user.hash()).toBe(row.end);
      });
    });
  }
});

describe("the keys of a run", () => {
  test("run, pause, single step, rewind and restart go where they say", async () => {
    await withPlayground("#scene=paper", async ({ user }) => {
      const start = await user.hash();
      await user.press("Single step");
      await user.page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
      const first = await user.hash();
      expect(first).not.toBe(start);
      await user.runPast(60);
      await user.press("Rewind");
      const rewound = await user.step();
      await user.press("Restart");
      await user.opened();
      expect(await user.hash()).toBe(start);
      expect(rewound).toBeGreaterThanOrEqual(0);
      await user.press("Single step");
      await user.page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
      expect(await user.hash()).toBe(first);
    });
  });

  test("the line of time goes back and on again to the same bits", async () => {
    await withPlayground("#scene=melting", async ({ page, user }) => {
      await user.runPast(40);
      const [step, hash] = [await user.step(), await user.hash()];
      const timeline = page.getByRole("slider", { name: "Step of the run" });
      await timeline.fill("10");
      await page.waitForFunction((before) => document.querySelector(".status code")?.textContent !== before, hash);
      expect(await user.step()).toBeLessThanOrEqual(10);
      await timeline.fill(String(step));
      await page.waitForFunction(
        (wanted) => Number((document.querySelector(".status span b")?.textContent ?? "").replaceAll(/\D/g, "")) === wanted,
        step,
      );
      expect(await user.hash()).toBe(hash);
    });
  });

  test("keys of the keyboard do the same, and none of them while a text is written", async () => {
    await withPlayground("#scene=paper", async ({ page, user }) => {
      await page.locator("main").focus();
      await page.keyboard.press(".");
      await page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
      await page.keyboard.press("Space");
      await page.getByRole("button", { name: "Pause" }).waitFor();
      await page.keyboard.press("Space");
      await page.getByRole("button", { name: "Run", exact: true }).waitFor();
      await page.keyboard.press("r");
      await user.opened();
      const grid = page.getByRole("checkbox", { name: /Grid/ });
      const before = await grid.isChecked();
      await page.keyboard.press("g");
      expect(await grid.isChecked()).toBe(!before);
      const colour = await page.getByRole("combobox", { name: "Colour by" }).inputValue();
      await page.keyboard.press("c");
      expect(await page.getByRole("combobox", { name: "Colour by" }).inputValue()).not.toBe(colour);
      await page.keyboard.press("?");
      await page.getByRole("dialog").waitFor();
      await page.keyboard.press("Escape");
      await page
        .locator("details", { has: page.getByText("Set-up as TOML", { exact: true }) })
        .locator("summary")
        .click();
      await page.getByRole("textbox", { name: "The set-up as TOML" }).focus();
      await page.keyboard.type("g.r ");
      expect(await user.step()).toBe(0);
      expect(await grid.isChecked()).toBe(!before);
    });
  });

  test("all of a run is reached by the tab key", async () => {
    await withPlayground("", async ({ page }) => {
      const names = new Set<string>();
      for (let i = 0; i < 60; ++i) {
        await page.keyboard.press("Tab");
        names.add(
          await page.evaluate(
            () => document.activeElement?.getAttribute("aria-label") ?? document.activeElement?.textContent ?? "",
          ),
        );
      }
      for (const name of [
        "Run",
        "Single step",
        "Rewind",
        "Restart",
        "Steps a second",
        "Scene",
        "Engine",
        "Colour by",
        "state hash",
        "Save",
      ]) {
        if (name === "Rewind") continue; // which is disabled at the start
        expect([...names].filter((one) => one.startsWith(name)).length, name).toBeGreaterThan(0);
      }
    });
  });

  test("no step comes before its rate says so, and ten times the rate takes less time", { timeout: 240_000 }, async () => {
    const secondsOfAStep = async (rate: number): Promise<number> => {
      let seconds = 0;
      await withPlayground(`#scene=paper&speed=${rate}`, async ({ page, user }) => {
        // By the clock of the page, read before the first step and after the last: another load makes the time longer, never shorter.
        const now = (): Promise<number> => page.evaluate(() => performance.now() / 1000);
        const begin = await now();
        await user.runPast(40);
        const steps = await user.step();
        const passed = (await now()) - begin;
        expect(steps).toBeLessThanOrEqual(rate * passed + 1);
        seconds = passed / steps;
      });
      return seconds;
    };
    expect(await secondsOfAStep(200)).toBeLessThan(await secondsOfAStep(20));
  });
});

describe("the set-up", () => {
  test("every slider and choice makes another run, and the run that moved keeps moving", async () => {
    await withPlayground("#scene=paper", async ({ page, user }) => {
      let before = await user.hash();
      const changed = async (act: () => Promise<void>): Promise<void> => {
        await act();
        await page.waitForFunction((hash) => {
          const now = document.querySelector(".status code")?.textContent ?? "";
          return now.length === 16 && now !== hash;
        }, before);
        before = await user.hash();
      };
      await changed(() => user.setNumber("Packing fraction φ", 0.6));
      await changed(() => user.setNumber("Number of disks N", 400));
      await changed(async () => void (await page.getByRole("combobox", { name: "Start" }).selectOption("triangular")));
      await changed(() => user.setNumber("Speed vₘₐₓ", 2));
      await changed(() => user.setNumber("Seed", 7));
      await changed(async () => void (await page.getByRole("combobox", { name: "Edge of the box" }).selectOption("periodic")));
      for (const [label, value] of [
        ["Engine", "exact"],
        ["Engine", "tiled"],
      ] as const) {
        await page.getByRole("combobox", { name: label }).selectOption(value);
        await user.opened();
        await user.runPast(3);
        expect(await user.step()).toBeGreaterThan(3);
      }
      await user.press("Run");
      await user.setNumber("Packing fraction φ", 0.5);
      await page.getByRole("button", { name: "Pause" }).waitFor();
      await page.waitForFunction(
        () => Number((document.querySelector(".status span b")?.textContent ?? "").replaceAll(/\D/g, "")) > 5,
      );
    });
  });

  test("a slider that is dragged changes the run while it is dragged", async () => {
    await withPlayground("#scene=paper", async ({ page, user }) => {
      const before = await user.hash();
      const slider = page.getByRole("slider", { name: "Packing fraction φ" });
      await slider.focus();
      // Runs open while the slider moves on: the number beside it must follow the slider, not them.
      await page.evaluate(() => {
        const shown: number[] = [];
        Object.assign(window, { shown });
        const own = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
        Object.defineProperty(document.querySelector("#setting-disks-packing_fraction"), "value", {
          get(this: HTMLInputElement) {
            return own?.get?.call(this) as string;
          },
          set(this: HTMLInputElement, value: string) {
            shown.push(Number(value));
            own?.set?.call(this, value);
          },
        });
      });
      for (let i = 0; i < 30; ++i) await page.keyboard.press("ArrowLeft");
      await page.waitForFunction((hash) => {
        const now = document.querySelector(".status code")?.textContent ?? "";
        return now.length === 16 && now !== hash;
      }, before);
      await user.opened();
      const shown = await page.evaluate(() => (window as unknown as { shown: number[] }).shown);
      expect(shown).toEqual(shown.toSorted((a, b) => b - a));
      expect(shown.at(-1)).toBeLessThan(0.68);
      expect(shown.at(-1)).toBeGreaterThan(0.66);
    });
  });

  test("edges of x and y and fixed disks are set apart, and the walls of a scene stay", async () => {
    const { decodeLink } = await import("../../src/playground/link.ts");
    await withPlayground("#scene=hopper", async ({ page, user }) => {
      const svg = (): Promise<string> =>
        page.evaluate(async () => {
          const { drawing } = (globalThis as unknown as { gridlock: { drawing: { picture(format: "svg"): Promise<Blob> } } }).gridlock;
          return (await drawing.picture("svg")).text();
        });
      const walls = async (): Promise<number> => (await svg()).match(/stroke-width="2"/g)?.length ?? 0;
      const dashed = async (): Promise<number> => (await svg()).match(/stroke-dasharray/g)?.length ?? 0;
      expect([await walls(), await dashed()]).toEqual([2, 0]);
      await page.getByRole("combobox", { name: "Left and right edge" }).selectOption("periodic");
      await expect.poll(dashed).toBe(2);
      await user.setNumber("Share of fixed disks", 0.1);
      const linked = async (): Promise<string> => (await decodeLink(new URL(page.url()).hash)).toml ?? "";
      await expect.poll(linked).toMatch(/fixed = true[^]*walls = \[\{/);
      expect(await page.getByRole("spinbutton", { name: "Share of fixed disks" }).inputValue()).toBe("0.1");
      await user.runPast(3);
      expect([await walls(), await dashed()]).toEqual([2, 2]);
      expect(await page.getByRole("alert").isVisible()).toBe(false);
    });
  });

  test("what cannot be set up is refused in the words of the command line, and the run before stays", async () => {
    await withPlayground("#scene=paper", async ({ page, user }) => {
      const before = await user.hash();
      await user.setNumber("Packing fraction φ", 0.8);
      const problem = page.getByRole("alert");
      await problem.waitFor();
      expect(await problem.innerText()).toMatch(/hint/);
      expect(await user.hash()).toBe(before);
      await user.openToml("[disks]\ncuont = 3\n");
      await page.getByText("cuont").first().waitFor();
      expect(await problem.innerText()).toMatch(/2/); // the line
      expect(await user.hash()).toBe(before);
      await user.openToml("[disks]\ncount = 9\npacking_fraction = 0.3\n");
      await page.getByText("9 disks").waitFor();
      expect(await problem.isVisible()).toBe(false);
    });
  });

  test("any setting is explained and set by its name", async () => {
    await withPlayground("#scene=paper", async ({ page, user }) => {
      await page.getByText("Any other setting").click();
      await page.getByRole("combobox", { name: "Name of a setting" }).fill("engine.substeps");
      await page
        .getByText(/Equal parts of a time step/)
        .last()
        .waitFor();
      const before = await user.hash();
      await page.getByRole("textbox", { name: "Its value" }).fill("2");
      await page.getByRole("button", { name: "Set", exact: true }).click();
      await user.opened();
      expect(await user.hash()).toBe(before); // of the start, which does not know how disks move
      await user.press("Single step");
      await page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
      expect(page.url()).toContain("#toml=");
    });
  });

  test("a link opens the same set-up with the same look", async () => {
    let url = "";
    let hash = "";
    await withPlayground("#scene=melting", async ({ page, user }) => {
      await user.setNumber("Seed", 5);
      await user.opened();
      await user.colourBy("speed");
      await page.getByRole("checkbox", { name: /Grid/ }).check();
      await user.press("Copy a link to this set-up");
      await page
        .getByRole("status")
        .getByText(/copied|Link|allows/)
        .waitFor();
      hash = await user.hash();
      url = page.url();
    });
    expect(url).toContain("#toml=");
    await withPlayground(url.slice(url.indexOf("#")), async ({ page, user }) => {
      expect(await user.hash()).toBe(hash);
      expect(await page.getByRole("spinbutton", { name: "Seed" }).inputValue()).toBe("5");
      expect(await page.getByRole("combobox", { name: "Colour by" }).inputValue()).toBe("speed");
      expect(await page.getByRole("checkbox", { name: /Grid/ }).isChecked()).toBe(true);
    });
  });

  test("a link with a set-up that is refused says why, and the page shows the usual scene", async () => {
    const { encodeLink } = await import("../../src/playground/link.ts");
    await withPlayground(await encodeLink({ toml: "disks.count = -3\n" }), async ({ page, user }) => {
      expect(await page.getByRole("alert").innerText()).toMatch(/disks\.count/);
      expect(await page.locator(".status").getByText("841 disks").isVisible()).toBe(true);
      expect(await user.step()).toBe(0);
    });
  });

  test("a link holds the rate, unlimited too, whether the grid is shown, and the colour of a scene that was changed", async () => {
    let url = "";
    let colour = "";
    await withPlayground("#scene=paper", async ({ page, user }) => {
      await user.setNumber("Seed", 5);
      await user.opened();
      colour = await page.getByRole("combobox", { name: "Colour by" }).inputValue();
      expect(colour).toBe("neighbourhood");
      await page.getByRole("slider", { name: "Steps a second" }).fill("14");
      await page.getByRole("checkbox", { name: /Grid/ }).check();
      await expect.poll(() => page.url()).toMatch(/grid=1&speed=unlimited/);
      url = page.url();
    });
    await withPlayground(url.slice(url.indexOf("#")), async ({ page }) => {
      expect(await page.getByText("unlimited").isVisible()).toBe(true);
      expect(await page.getByRole("checkbox", { name: /Grid/ }).isChecked()).toBe(true);
      expect(await page.getByRole("combobox", { name: "Colour by" }).inputValue()).toBe(colour);
    });
  });

  test("of links that are opened one after the other the last one wins", async () => {
    const { decodeLink, encodeLink } = await import("../../src/playground/link.ts");
    const links = await Promise.all([30, 20_000, 31, 32].map((count) => encodeLink({ toml: `disks.count = ${count}\ndisks.packing_fraction = 0.3\n` })));
    const openOneAfterTheOther = (all: readonly string[]): void => {
      for (const link of all) location.hash = link;
    };
    await withPlayground(links[0] as string, async ({ page, user }) => {
      await page.evaluate(openOneAfterTheOther, [links[1], links[2], links[3]] as string[]);
      await page.getByText("32 disks").waitFor();
      await user.ready();
      await page.evaluate(openOneAfterTheOther, ["#scene=melting", links[1], links[2]] as string[]);
      await page.getByText("31 disks").waitFor();
      await page.waitForTimeout(500);
      expect(await page.getByText("31 disks").isVisible()).toBe(true);
      expect((await decodeLink(new URL(page.url()).hash)).toml).toContain("disks.count = 31\n");
    });
    // Also while the page opens the first one.
    const { page, complaints } = await openWatched(browser, address + links[1]);
    await page.locator(".picture").waitFor();
    await page.evaluate(openOneAfterTheOther, [links[3]] as string[]);
    await page.getByText("32 disks").waitFor();
    await page.waitForTimeout(500);
    expect(await page.getByText("32 disks").isVisible()).toBe(true);
    expect(complaints).toEqual([]);
    await page.context().close();
  });

  test("one that takes long says so, leaves the page usable, and is stopped by a key or by another set-up", async () => {
    const LONG = "disks.count = 4_000_000\ndisks.packing_fraction = 0.5\n";
    await withPlayground("#scene=paper", async ({ page, user }) => {
      const before = await user.hash();
      await user.openToml(LONG);
      await page.getByText("The run is being set up.").waitFor();
      const frames = await page.evaluate(async () => {
        const begin = performance.now();
        let frames = 0;
        for (; performance.now() - begin < 300; ++frames) await new Promise(requestAnimationFrame);
        return frames;
      });
      expect(frames).toBeGreaterThan(2);
      await user.press("Stop");
      await page.getByText("The run is being set up.").waitFor({ state: "hidden" });
      await user.opened();
      expect(await user.hash()).toBe(before);
      expect(await page.locator(".status").getByText("841 disks").isVisible()).toBe(true);
      await user.press("Single step");
      await page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
      await user.openToml(LONG);
      await page.getByText("The run is being set up.").waitFor();
      await user.openToml("disks.count = 9\ndisks.packing_fraction = 0.3\n");
      await page.locator(".status").getByText("9 disks", { exact: true }).waitFor();
      await user.runPast(3);
    });
  });

  test("a damaged link is told, and the page works", async () => {
    await withPlayground("#toml=AAAA", async ({ page, user }) => {
      expect(await page.getByRole("alert").innerText()).toMatch(/damaged/);
      await user.press("Single step");
      await page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
    });
  });
});

describe("the look", () => {
  test("every colour of every kind of agents is drawn, with a legend where it means numbers", { timeout: 120_000 }, async () => {
    for (const scene of ["paper", "flocking", "epidemic", "catalyst", "mixture"]) {
      await withPlayground(`#scene=${scene}`, async ({ page, user }) => {
        await user.runPast(3);
        const options = await page
          .getByRole("combobox", { name: "Colour by" })
          .locator("option")
          .evaluateAll((all) => all.map((one) => (one as HTMLOptionElement).value));
        expect(options.length, scene).toBeGreaterThan(3);
        for (const option of options) {
          await user.colourBy(option);
          await page.waitForTimeout(150);
          expect(await user.coloursInPicture(), `${scene} by ${option}`).toBeGreaterThan(1);
        }
      });
    }
  });

  test("a click on a disk shows its values and the block of nine cells, a click beside it hides them", async () => {
    await withPlayground("#scene=paper&grid=1", async ({ page, user }) => {
      const picture = page.locator(".picture canvas").last();
      const box = (await picture.boundingBox())!;
      await picture.focus();
      await page.keyboard.press("Enter"); // the disk in the middle
      await page.getByText(/The search looks at \d+ of 840 others, in 9 cells of 10 × 10/).waitFor();
      await page.getByRole("term").filter({ hasText: "velocity x" }).waitFor();
      await user.press("Single step");
      await page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "1");
      expect(await page.getByText(/The search looks at/).isVisible()).toBe(true);
      await page.mouse.click(box.x + 3, box.y + 3); // outside the box
      await page.getByText(/The search looks at/).waitFor({ state: "hidden" });
    });
  });

  test("a packing shows its forces, which can be hidden", async () => {
    await withPlayground("#scene=jamming", async ({ page, user }) => {
      const forces = page.getByRole("checkbox", { name: "Forces of the packing" });
      expect(await forces.isVisible()).toBe(false);
      await user.press("Run");
      await forces.waitFor({ timeout: 60_000 });
      const inkOfOverlay = (): Promise<number> =>
        page.evaluate(() => {
          const overlay = [...document.querySelectorAll<HTMLCanvasElement>(".picture canvas")].at(-1) as HTMLCanvasElement;
          const copy = new OffscreenCanvas(overlay.width, overlay.height).getContext("2d") as OffscreenCanvasRenderingContext2D;
          copy.drawImage(overlay, 0, 0);
          const bytes = copy.getImageData(0, 0, overlay.width, overlay.height).data;
          return bytes.filter((value, i) => i % 4 === 3 && value > 0).length;
        });
      // The box and the legend alone have about 5,000 pixels.
      await expect.poll(inkOfOverlay).toBeGreaterThan(15_000);
      await forces.uncheck();
      await expect.poll(inkOfOverlay).toBeLessThan(8_000);
    });
  });

  test("a packing shows its stages, charts and results in place of charts against time, and its density beside the slider", async () => {
    await withPlayground("#scene=jamming", async ({ page, user }) => {
      const side = page.getByRole("complementary", { name: "Charts" });
      const density = page.locator(".field", { has: page.getByRole("spinbutton", { name: "Packing fraction φ" }) }).locator(".hint");
      expect(await density.innerText()).toBe("Of the start. Now φ = 0.5, in stage 1 of 2, quench.");
      expect(await side.getByText("Stages are listed here as they end.").isVisible()).toBe(true);
      expect(await side.locator(".chart:visible").count()).toBe(0);
      await user.press("Run");
      await side.getByText("Jamming at φJ").waitFor({ timeout: 60_000 });
      expect(await side.locator(".chart:visible h3").allInnerTexts()).toEqual([
        "Pressure of soft disks",
        "Contact number",
        "Elastic moduli, stage 2 decompress",
      ]);
      const cells = (row: string): Promise<string[]> => side.getByRole("row", { name: row }).locator("td").allInnerTexts();
      expect(await cells("1 quench")).toEqual(["0.86", "0.00774"]);
      const [end] = await cells("2 decompress");
      expect(await density.innerText()).toBe(`Of the start. Now φ = ${end}, after the protocol.`);
      const jamming = Number((await side.locator("dt", { hasText: "Jamming at φJ" }).locator("+ dd").innerText()).split(" ")[0]);
      // Just below the last minimum, whose pressure is 10⁻⁸.
      expect(Number(end) - jamming).toBeGreaterThan(-1e-5);
      expect(Number(end) - jamming).toBeLessThan(1e-4);
      await user.press("Restart");
      await side.getByText("Stages are listed here as they end.").waitFor();
    });
  });

  test("a sheared packing has its stress against the strain, and sliders of its stages that change it", { timeout: 180_000 }, async () => {
    await withPlayground("#scene=shear", async ({ page, user }) => {
      const side = page.getByRole("complementary", { name: "Charts" });
      const start = await user.hash();
      const end = async (): Promise<string> => {
        await user.press("Run");
        await side.locator("dt", { hasText: "First at γ" }).waitFor({ timeout: 90_000 });
        return user.hash();
      };
      // A new set-up stands at step 0, as the packing before it does: only its stages are gone.
      const opened = (): Promise<void> => side.getByText("Stages are listed here as they end.").waitFor();
      const first = await end();
      expect(first).not.toBe(start);
      expect(await side.locator(".chart:visible h3").allInnerTexts()).toEqual(expect.arrayContaining(["Stress against strain", "Pressure under shear"]));
      const points = await page.getByRole("figure", { name: /^Stress against strain: / }).locator("canvas").evaluate((canvas: HTMLCanvasElement) => {
        const { data } = (canvas.getContext("2d") as CanvasRenderingContext2D).getImageData(0, 0, canvas.width, canvas.height);
        // Blue, the colour of the curve; axes and text are grey.
        return data.filter((value, i) => i % 4 === 2 && value > (data[i - 2] as number) + 60).length;
      });
      expect(points).toBeGreaterThan(300);
      expect(await side.locator("dt", { hasText: "Strain γ" }).locator("+ dd").innerText()).toBe("0.2");
      await user.setNumber("Shear to strain γ", 0.05);
      await opened();
      const shorter = await end();
      expect(await side.locator("dt", { hasText: "Strain γ" }).locator("+ dd").innerText()).toBe("0.05");
      await user.setNumber("Quench at φ", 0.9);
      await user.press("Run"); // while the set-up is being opened
      await side.getByRole("row", { name: "1 quench 0.9" }).waitFor();
      expect(await page.getByRole("spinbutton", { name: "Shear to strain γ" }).inputValue()).toBe("0.05");
      await side.locator("dt", { hasText: "First at γ" }).waitFor();
      expect(new Set([first, shorter, await user.hash()]).size).toBe(3);
    });
  });

  test("the wheel, dragging, the keyboard and a double click move the picture", async () => {
    await withPlayground("#scene=paper", async ({ page }) => {
      const picture = page.locator(".picture canvas").last();
      const box = (await picture.boundingBox())!;
      const scale = (): Promise<number> =>
        page.evaluate(
          () => (globalThis as unknown as { gridlock: { drawing: { camera: { scale: number } } } }).gridlock.drawing.camera.scale,
        );
      const all = await scale();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.wheel(0, -400);
      await expect.poll(scale).toBeGreaterThan(1.5 * all);
      await picture.focus();
      await page.keyboard.press("-");
      await page.keyboard.press("0");
      await expect.poll(scale).toBeCloseTo(all, 6);
      await page.keyboard.press("+");
      await expect.poll(scale).toBeGreaterThan(1.2 * all);
      await page.mouse.dblclick(box.x + box.width / 2, box.y + box.height / 2);
      await expect.poll(scale).toBeCloseTo(all, 6);
    });
  });

  test("a distance is measured from centre to centre", async () => {
    await withPlayground("#scene=paper", async ({ page, user }) => {
      const at = await page.evaluate(() => {
        const camera = (
          globalThis as unknown as {
            gridlock: { drawing: { camera: { toPixels(place: { x: number; y: number }): { x: number; y: number } } } };
          }
        ).gridlock.drawing.camera;
        const canvas = document.querySelector(".picture canvas")!.getBoundingClientRect();
        return [0, 3].map((site) => {
          const pixel = camera.toPixels({ x: (site + 0.5) / 29, y: 0.5 / 29 });
          return { x: canvas.x + pixel.x, y: canvas.y + pixel.y };
        });
      });
      await page.evaluate(() => {
        const { drawing } = (globalThis as unknown as { gridlock: { drawing: { onMeasure(length: number): void } } }).gridlock;
        drawing.onMeasure = (length) => {
          document.title = String(length);
        };
      });
      await user.press("Measure a distance");
      await page.mouse.move(at[0]!.x + 2, at[0]!.y + 1);
      await page.mouse.down();
      await page.mouse.move(at[1]!.x - 2, at[1]!.y, { steps: 4 });
      await page.mouse.up();
      expect(Number(await page.title())).toBeCloseTo(3 / 29, 6);
    });
  });

  test("charts follow the run, one more quantity can be added, and a click in one goes to its time", async () => {
    await withPlayground("#scene=melting", async ({ page, user }) => {
      await user.runPast(60);
      const step = await user.step();
      expect(await page.locator(".chart h3").allInnerTexts()).toEqual(
        expect.arrayContaining(["Mean displacement", "Compressibility factor Z = PA / NkT", "Sixfold order |ψ6|"]),
      );
      await expect
        .poll(async () =>
          Number(await page.locator(".chart").filter({ hasText: "Mean displacement" }).locator(".value").innerText()),
        )
        .toBeGreaterThan(0);
      await page.getByRole("combobox", { name: "Another quantity" }).selectOption("kinetic_energy");
      await page.getByRole("heading", { name: "Kinetic energy" }).waitFor();
      const plot = (await page.locator(".chart .u-over").first().boundingBox())!;
      await page.mouse.click(plot.x + plot.width / 4, plot.y + plot.height / 2);
      await expect.poll(() => user.step()).toBeLessThan(step);
    });
  });

  test("a scene has a guide whose names are on the page, and a set-up of one's own has none", async () => {
    await withPlayground("#scene=melting", async ({ page, user }) => {
      const guide = page.locator(".guide");
      expect(await guide.locator("p i").allInnerTexts()).toEqual(["Do", "Look at", "Ask"]);
      expect(await guide.locator("b").allInnerTexts()).toContain("Packing fraction φ");
      await user.openToml("# My own disks.\ndisks.count = 9\ndisks.packing_fraction = 0.3\n");
      await page.locator(".status").getByText("9 disks", { exact: true }).waitFor();
      expect(await guide.innerText()).toBe("My own disks.");
    });
  });

  test("what is chosen under the picture is in view on small screens, and the page says its version", async () => {
    for (const viewport of [
      { width: 1280, height: 800 },
      { width: 1000, height: 700 },
    ]) {
      await withPlayground(
        "#scene=paper",
        async ({ page }) => {
          for (const control of [page.getByRole("combobox", { name: "Colour by" }), page.getByRole("checkbox", { name: /Grid/ })]) {
            const box = (await control.boundingBox())!;
            expect(box.y + box.height, JSON.stringify(viewport)).toBeLessThanOrEqual(viewport.height);
          }
          const version = await page.locator(".version").innerText();
          expect(version).toMatch(/^\d+\.\d+\.\d+.*\+(unknown|[0-9a-f]{12})/);
          await page.getByRole("button", { name: "Help" }).click();
          await page.getByRole("dialog").getByText(`Gridlock ${version}`).waitFor();
        },
        { viewport },
      );
    }
  });

  test("light and dark are chosen and kept", async () => {
    await withPlayground("", async ({ page }) => {
      const theme = (): Promise<string | undefined> => page.evaluate(() => document.documentElement.dataset["theme"]);
      expect(await theme()).toBe("light");
      await page.getByRole("button", { name: "Light or dark" }).click();
      expect(await theme()).toBe("dark");
      await page.reload();
      expect(await theme()).toBe("dark");
    });
    await withPlayground(
      "",
      async ({ page }) => {
        expect(await page.evaluate(() => document.documentElement.dataset["theme"])).toBe("dark");
      },
      { colorScheme: "dark" },
    );
  });
});

describe("what is taken home", () => {
  const FILES: readonly [RegExp, RegExp, (bytes: Buffer) => void][] = [
    [/^Picture, PNG/, /^paper_\d+\.png$/, (bytes) => expect(bytes.subarray(1, 4).toString()).toBe("PNG")],
    [/^Picture, SVG/, /^paper_\d+\.svg$/, (bytes) => expect(bytes.toString().match(/<circle/g)?.length).toBe(841)],
    [
      /^Series, CSV/,
      /^paper_series\.csv$/,
      (bytes) => expect(bytes.toString().split("\n")[0]).toMatch(/^step,time,.*mean_displacement/),
    ],
    [/^Set-up, TOML/, /^paper\.toml$/, (bytes) => expect(bytes.toString()).toMatch(/packing_fraction/)],
  ];

  test("picture, series and set-up are files with what they say", async () => {
    const { readFile } = await import("node:fs/promises");
    await withPlayground("#scene=paper", async ({ page, user }) => {
      await user.runPast(5);
      for (const [item, name, check] of FILES) {
        await user.press("Save");
        const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("menuitem", { name: item }).click()]);
        expect(download.suggestedFilename()).toMatch(name);
        check(await readFile(await download.path()));
      }
    });
  });

  test("a video of the run", async () => {
    const { readFile } = await import("node:fs/promises");
    await withPlayground("#scene=paper", async ({ page, user }) => {
      await user.press("Save");
      await page.getByRole("menuitem", { name: /^Begin a video/ }).click();
      await user.runPast(60);
      await user.press("Save");
      const [download] = await Promise.all([
        page.waitForEvent("download"),
        page.getByRole("menuitem", { name: /^End the video/ }).click(),
      ]);
      expect(download.suggestedFilename()).toBe("paper.webm");
      const bytes = await readFile(await download.path());
      expect(bytes.subarray(0, 4).toString("hex")).toBe("1a45dfa3"); // Matroska
      expect(bytes.length).toBeGreaterThan(10_000);
    });
  });
});
