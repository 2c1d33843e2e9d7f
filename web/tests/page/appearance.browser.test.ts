import { readdirSync, readFileSync, statSync } from "node:fs";
import type { Server } from "node:http";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

import type { Browser, BrowserContextOptions, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { findings, openWatched, PAGE_FOLDER, servePage, startBrowser } from "../support/browser.ts";
import { differenceFromReference, reference, shareOfDifferences } from "../support/pictures.ts";
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

async function withPage(
  hash: string,
  options: BrowserContextOptions,
  use: (user: PlaygroundDriver, page: Page) => Promise<void>,
): Promise<void> {
  const { page, complaints } = await openWatched(browser, address + hash, options);
  try {
    const user = new PlaygroundDriver(page);
    await user.ready();
    await use(user, page);
    expect(complaints).toEqual([]);
  } finally {
    await page.context().close();
  }
}

const DESKTOP: BrowserContextOptions = { viewport: { width: 1440, height: 900 } };
const SMALL: BrowserContextOptions = { viewport: { width: 900, height: 640 } };
const PHONE: BrowserContextOptions = {
  viewport: { width: 390, height: 844 },
  deviceScaleFactor: 2,
  isMobile: true,
  hasTouch: true,
};
const SMALL_PHONE: BrowserContextOptions = { ...PHONE, viewport: { width: 360, height: 640 } };
/** Of pixels; letters are drawn by fonts, which differ a little from machine to machine. */
const TOLERANCE = 0.01;

describe("pictures are those of the references", () => {
  const goTo = async (user: PlaygroundDriver, step: number): Promise<void> => {
    for (let i = 0; i < step; ++i) {
      await user.press("Single step");
      await user.page.waitForFunction(
        (wanted) => document.querySelector(".status span b")?.textContent === String(wanted),
        i + 1,
      );
    }
    await user.ready();
    await user.page.waitForTimeout(300);
  };
  const NAMES = ["neighbourhoods", "block", "melting_psi6", "flock", "mixture", "webgl"];

  test("the paper's Figure 4", async () => {
    await withPage("#scene=paper&grid=1", SMALL, async (user, page) => {
      await goTo(user, 20);
      expect(differenceFromReference("neighbourhoods", await page.locator(".picture").screenshot())).toBeLessThan(TOLERANCE);
    });
  });

  test("the paper's Figure 2: the block of the disk in the middle", async () => {
    await withPage("#scene=paper&grid=1&colour=plain", SMALL, async (user, page) => {
      await page.locator(".picture canvas").last().focus();
      await page.keyboard.press("Enter");
      await page.getByText(/The search looks at/).waitFor();
      await page.locator("main").focus();
      await page.waitForTimeout(300);
      expect(differenceFromReference("block", await page.locator(".picture").screenshot())).toBeLessThan(TOLERANCE);
      await user.ready();
    });
  });

  for (const [name, hash, steps] of [
    ["melting_psi6", "#scene=melting", 20],
    ["flock", "#scene=vicsek", 20],
    ["mixture", "#scene=mixture", 2],
  ] as const) {
    test(name.replaceAll("_", " by "), async () => {
      await withPage(hash, SMALL, async (user, page) => {
        await goTo(user, steps);
        expect(differenceFromReference(name, await page.locator(".picture").screenshot())).toBeLessThan(TOLERANCE);
      });
    });
  }

  test("WebGL draws what the loops over pixels draw", async () => {
    await withPage("?renderer=webgl#scene=paper&grid=1", SMALL, async (user, page) => {
      await goTo(user, 20);
      const picture = await page.locator(".picture").screenshot();
      expect(differenceFromReference("webgl", picture)).toBeLessThan(TOLERANCE);
      expect(shareOfDifferences(reference("webgl"), reference("neighbourhoods"))).toBeLessThan(TOLERANCE);
    });
  });

  test("the tolerance tells the references apart", () => {
    const different = NAMES.filter((name) => name !== "webgl");
    different.forEach((one, i) =>
      different.slice(i + 1).forEach((other) => {
        expect(shareOfDifferences(reference(one), reference(other)), `${one} and ${other}`).toBeGreaterThan(5 * TOLERANCE);
      }),
    );
  });
});

describe("nobody is left out", () => {
  for (const [name, options] of [
    ["light", DESKTOP],
    ["dark", { ...DESKTOP, colorScheme: "dark" }],
    ["on a phone", PHONE],
    ["on a phone, dark", { ...PHONE, colorScheme: "dark" }],
  ] as const) {
    test(`axe-core finds nothing ${name}, with everything open`, async () => {
      await withPage("#scene=epidemic", options, async (user, page) => {
        for (const summary of await page.locator("summary:visible").all()) await summary.click();
        await user.runPast(20);
        await page.locator(".picture canvas").last().focus();
        await page.keyboard.press("Enter");
        expect(await findings(page)).toEqual([]);
        await user.press("Save");
        expect(await findings(page)).toEqual([]);
        await page.keyboard.press("Escape");
        await page.getByRole("button", { name: "Help" }).click();
        await page.getByText("Licences of what is inside").click();
        await page.getByText(/Leon Sorokin/).waitFor();
        expect(await findings(page)).toEqual([]);
      });
    });
  }

  test("on a small phone no key lies over another, or over what the run says", async () => {
    await withPage("#scene=paper", SMALL_PHONE, async (_, page) => {
      const keys = (await page.getByRole("group", { name: "Run" }).boundingBox())!;
      for (const part of [".status", ".tools", "input[aria-label='Step of the run']"]) {
        const box = (await page.locator(part).first().boundingBox())!;
        expect(box.y + box.height, part).toBeLessThanOrEqual(keys.y);
      }
      const picture = (await page.locator(".picture").boundingBox())!;
      expect(picture.height).toBeGreaterThan(300);
    });
  });

  test("a phone shows all without scrolling sideways, with keys a finger can hit", async () => {
    for (const width of [320, 390]) {
      await withPage("#scene=paper", { ...PHONE, viewport: { width, height: 700 } }, async (user, page) => {
        expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(width);
        for (const name of ["Restart", "Rewind", "Run", "Single step", "Save", "Help"]) {
          const box = (await page.getByRole("button", { name, exact: true }).boundingBox())!;
          expect(Math.min(box.width, box.height), name).toBeGreaterThanOrEqual(40);
        }
        await page.getByRole("button", { name: "Run", exact: true }).tap();
        await page.getByRole("button", { name: "Pause", exact: true }).tap();
        await user.ready();
        expect(await user.step()).toBeGreaterThan(0);
        const picture = (await page.locator(".picture canvas").last().boundingBox())!;
        await page.touchscreen.tap(picture.x + picture.width / 2, picture.y + picture.width / 2);
        await page.getByText(/The search looks at/).waitFor();
      });
    }
  });
});

describe("what is loaded", () => {
  /** All that a browser loads at first, and what it may load later. */
  const files = (folder: string): string[] =>
    readdirSync(folder, { withFileTypes: true }).flatMap((entry) =>
      entry.isDirectory() ? files(join(folder, entry.name)) : [join(folder, entry.name)],
    );

  test("the page is at most 3 MB compressed", () => {
    const parts = files(PAGE_FOLDER).filter((file) => !file.endsWith("playground.html"));
    const bytes = parts.reduce((sum, file) => sum + gzipSync(readFileSync(file), { level: 9 }).length, 0);
    console.log(
      `the page: ${(bytes / 1e6).toFixed(2)} MB compressed, ${(parts.reduce((sum, file) => sum + statSync(file).size, 0) / 1e6).toFixed(2)} MB`,
    );
    expect(bytes).toBeLessThan(3e6);
  });
});
