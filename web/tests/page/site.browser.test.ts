/** The site of ./dev site, where it has been made: its figures run, and it leads to other versions. */

import { execFileSync } from "node:child_process";
import { existsSync, globSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import type { Server } from "node:http";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import type { Browser, BrowserContextOptions, Frame, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { findings, openWatched, servePage, startBrowser } from "../support/browser.ts";

const ROOT = join(import.meta.dirname, "../../..");
const SITE = process.env["GRIDLOCK_SITE"] ?? join(ROOT, "build-docs/html");
const isMade = existsSync(join(SITE, "playground/playground.html"));
const PROGRAM = process.env["GRIDLOCK_PROGRAM"] ?? join(ROOT, "build/apps/gridlock/gridlock");

/** The figures of all pages, as docs/site_parts.py finds them. */
const FIGURES = globSync("docs/**/*.md", { cwd: ROOT }).flatMap((file) => {
  const text = readFileSync(join(ROOT, file), "utf8");
  return [...text.matchAll(/<!-- live: (scene=(\w+)\S*) -->\n!\[.*?\]\((.*?)\)\n/g)].map(([, setUp = "", scene = "", picture = ""]) => ({
    page: file.replace(/^docs\/|\.md$/g, ""),
    text,
    setUp,
    scene,
    picture: join(ROOT, file, "..", picture),
  }));
});

/** What the command line gives. */
function hashOf(scene: string): string | undefined {
  const folder = mkdtempSync(join(tmpdir(), "gridlock-scene-"));
  try {
    const said = execFileSync(PROGRAM, ["run", join(ROOT, `scenes/${scene}.toml`), "-o", join(folder, "run"), "--no-pictures"], {
      encoding: "utf8",
      stdio: "pipe",
    });
    return /state_hash +([0-9a-f]{16})/.exec(said)?.[1];
  } finally {
    rmSync(folder, { recursive: true });
  }
}

describe.skipIf(!isMade)("the site", () => {
  let browser: Browser;
  let server: Server;
  let address: string;
  let folder: string;

  beforeAll(async () => {
    folder = mkdtempSync(join(tmpdir(), "gridlock-site-"));
    symlinkSync(SITE, join(folder, "v0.10.0"));
    symlinkSync(SITE, join(folder, "main"));
    mkdirSync(join(folder, "v0.9.0"));
    writeFileSync(join(folder, "v0.9.0/index.html"), "<title>v0.9.0</title>");
    execFileSync("python3", [join(ROOT, "docs/versions.py"), folder]);
    ({ address, server } = await servePage(folder));
    browser = await startBrowser();
  });

  afterAll(async () => {
    await browser?.close();
    server?.close();
    rmSync(folder, { recursive: true });
  });

  async function withPage(path: string, options: BrowserContextOptions, use: (page: Page) => Promise<void>): Promise<void> {
    const { page, complaints } = await openWatched(browser, address + path, options);
    try {
      await use(page);
      expect(complaints).toEqual([]);
    } finally {
      await page.context().close();
    }
  }

  /** Starts the figure of a page by the keyboard, and gives its frame. */
  async function start(page: Page): Promise<Frame> {
    await page.getByRole("button", { name: "Run it here" }).focus();
    await page.keyboard.press("Enter");
    const frame = await (await page.waitForSelector(".live-figure iframe")).contentFrame();
    await frame!.getByRole("button", { name: /^(Pause|Continue)/ }).waitFor({ timeout: 60_000 });
    return frame!;
  }

  test("has figures on the pages where a reader begins", () => {
    expect(FIGURES.map(({ page }) => page)).toEqual(expect.arrayContaining(["index", "getting_started/first_run"]));
  });

  test.each(FIGURES)("the figure of $page ends in the bits of the command line, which a page prints", async ({ page: path, scene, setUp, picture }) => {
    const wanted = hashOf(scene);
    expect(FIGURES.filter((one) => one.scene === scene && one.text.includes(String(wanted)))).not.toEqual([]);
    await withPage(`main/${path}.html`, {}, async (page) => {
      const frame = await start(page);
      await frame.getByRole("slider", { name: "Steps a second" }).fill("14"); // as fast as it can
      await frame.getByText("finished", { exact: true }).waitFor({ timeout: 280_000 });
      await expect.poll(() => frame.locator(".status code").innerText()).toBe(wanted);
      expect(await frame.getByRole("combobox").count()).toBe(0);
      expect(await frame.locator(".side input[type=range]").count()).toBe(setUp.includes("vary=") ? 1 : 0);
      expect((await frame.locator(".side .chart canvas").count()) > 0).toBe(setUp.includes("chart="));
      if (process.env["GRIDLOCK_WRITE_PICTURES"] !== undefined && basename(picture).startsWith("live_")) {
        await page.addStyleTag({ content: ".back-to-top { visibility: hidden; }" });
        await frame.locator("main").focus();
        await page.locator(".live-figure iframe").screenshot({ path: picture });
      }
    });
  }, 300_000);

  for (const [name, options] of [
    ["light, in a window of middle width", { viewport: { width: 1020, height: 800 } }],
    ["dark, on a phone", { colorScheme: "dark", viewport: { width: 375, height: 700 }, isMobile: true, hasTouch: true }],
  ] as const) {
    test(`axe-core finds nothing in a figure, which needs no scrolling and obeys the keyboard: ${name}`, async () => {
      await withPage("main/getting_started/first_run.html", options, async (page) => {
        const frame = await start(page);
        await page.keyboard.press(" ");
        await frame.getByText("paused", { exact: true }).waitFor();
        expect(await findings(frame)).toEqual([]);
        expect(await findings(page, ".live-figure")).toEqual([]);
        expect(await frame.evaluate(() => document.documentElement.dataset["theme"])).toBe("colorScheme" in options ? "dark" : "light");
        const beyond = await frame.evaluate(() => {
          const whole = document.documentElement;
          return { x: whole.scrollWidth - innerWidth, y: whole.scrollHeight - innerHeight };
        });
        expect(beyond).toEqual({ x: 0, y: 0 });
        expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(page.viewportSize()!.width);
      });
    });
  }

  test("without scripts a figure is its picture, and promises nothing", async () => {
    await withPage("main/getting_started/first_run.html", { javaScriptEnabled: false }, async (page) => {
      expect(await page.locator(".live-figure img").isVisible()).toBe(true);
      expect(await page.locator(".live-figure button").count()).toBe(0);
    });
  });

  test("pages say which version they describe, and lead to the same page of another, or to its first", async () => {
    const { page } = await openWatched(browser, `${address}main/getting_started/first_run.html`);
    const versions = page.getByRole("combobox", { name: "Version" });
    await page.getByText("This page describes main").waitFor();
    expect(await versions.locator("option").allInnerTexts()).toEqual(["v0.10.0", "v0.9.0", "main"]);
    expect(await versions.inputValue()).toBe("main");
    await page.getByRole("button", { name: "see v0.10.0, the newest release" }).click();
    await page.waitForURL(`${address}v0.10.0/getting_started/first_run.html`);
    await expect.poll(() => versions.inputValue()).toBe("v0.10.0");
    expect(await page.getByText("This page describes").count()).toBe(0);
    await versions.selectOption("v0.9.0");
    await page.waitForURL(`${address}v0.9.0/index.html`); // which has no page of that name
    await page.goto(address);
    await page.waitForURL(`${address}v0.10.0/index.html`);
    await page.goto(`${address}v0.10.0/search.html?q=rattler`);
    await page.locator("#search-results li a").first().waitFor();
    await page.context().close();
  });

  test("an address without a page leads to all versions", async () => {
    const { page } = await openWatched(browser, `${address}v0.9.0/no/such/page.html`);
    const links = await page.getByRole("link").evaluateAll((all) => all.map((one) => (one as HTMLAnchorElement).href));
    expect(links).toContain(`${address}v0.9.0/index.html`);
    expect(await findings(page)).toEqual([]);
    await page.context().close();
  });
});

test("every page names its address in the newest version that has it, and the map of the site those of the newest version", () => {
  const site = mkdtempSync(join(tmpdir(), "gridlock-site-"));
  try {
    for (const [name, pages] of [["v0.1.0", ["index", "old"]], ["v0.2.0", ["index"]], ["main", ["index", "new"]]] as const) {
      mkdirSync(join(site, name));
      for (const page of pages) writeFileSync(join(site, name, `${page}.html`), "<html>\n  <head><meta charset=\"utf-8\"/>\n<title>a page</title>\n</head>\n");
    }
    // The second time takes the place of the first.
    for (const at of ["https://before.org", "https://example.org/gridlock"]) {
      execFileSync("python3", [join(ROOT, "docs/versions.py"), site, "v0.3.0", join(site, "v0.2.0"), at]);
    }
    const found = (file: string, pattern: RegExp): (string | undefined)[] =>
      [...readFileSync(join(site, file), "utf8").matchAll(pattern)].map((match) => match[1]);
    const named = (page: string): (string | undefined)[] => found(page, /rel="canonical" href="(.*?)"/g);
    expect(named("v0.1.0/index.html")).toEqual(["https://example.org/gridlock/v0.3.0/index.html"]);
    expect(named("v0.1.0/old.html")).toEqual(["https://example.org/gridlock/v0.1.0/old.html"]);
    expect(named("main/new.html")).toEqual(["https://example.org/gridlock/main/new.html"]);
    expect(found("sitemap.xml", /<loc>(.*?)</g)).toEqual(["https://example.org/gridlock/v0.3.0/index.html"]);
  } finally {
    rmSync(site, { recursive: true });
  }
});
