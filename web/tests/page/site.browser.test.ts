/** The site of ./dev site, where it has been made: its figures run, and it leads to other versions. */

import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, test } from "vitest";

import { openWatched, servePage, startBrowser } from "../support/browser.ts";

const ROOT = join(import.meta.dirname, "../../..");
const SITE = process.env["GRIDLOCK_SITE"] ?? join(ROOT, "build-docs/html");
const isMade = existsSync(join(SITE, "playground/playground.html"));

test.skipIf(!isMade)("the figure of the first run gives the hash that its page prints, and a choice leads to another version", async () => {
  const folder = mkdtempSync(join(tmpdir(), "gridlock-site-"));
  symlinkSync(SITE, join(folder, "main"));
  for (const name of ["v0.9.0", "v0.10.0"]) {
    mkdirSync(join(folder, name));
    writeFileSync(join(folder, name, "index.html"), `<title>${name}</title>`);
  }
  execFileSync("python3", [join(ROOT, "docs/versions.py"), folder]);
  const { address, server } = await servePage(folder);
  const browser = await startBrowser();
  try {
    const { page, complaints } = await openWatched(browser, `${address}main/getting_started/first_run.html`);
    await page.getByRole("button", { name: "Run it here" }).click();
    const figure = page.frameLocator(".live-figure iframe");
    await figure.getByRole("slider", { name: "Steps a second" }).fill("14"); // as fast as it can
    await figure.getByRole("button", { name: "Run", exact: true }).click();
    await figure.getByText("finished", { exact: true }).waitFor({ timeout: 50_000 });
    const printed = /state_hash +([0-9a-f]{16})/.exec(readFileSync(join(ROOT, "docs/getting_started/first_run.md"), "utf8"))?.[1];
    await expect.poll(() => figure.locator(".status code").innerText()).toBe(printed);
    expect(await figure.getByRole("combobox").count()).toBe(0); // the picture and its keys alone
    expect(complaints).toEqual([]);

    const versions = page.getByRole("combobox", { name: "Version" });
    expect(await versions.locator("option").allInnerTexts()).toEqual(["v0.10.0", "v0.9.0", "main"]);
    expect(await versions.inputValue()).toBe("main");
    await versions.selectOption("v0.9.0");
    await page.waitForURL(`${address}v0.9.0/index.html`); // which has no page of that name
    await page.goto(address);
    await page.waitForURL(`${address}v0.10.0/index.html`);
  } finally {
    await browser.close();
    server.close();
    rmSync(folder, { recursive: true });
  }
});
