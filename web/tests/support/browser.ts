/** The built page in Debian's Chromium, served from this machine. */

import { createReadStream, existsSync, readFileSync, statSync } from "node:fs";
import { createServer, type Server } from "node:http";
import { createRequire } from "node:module";
import type { AddressInfo } from "node:net";
import { extname, join, normalize } from "node:path";

import { chromium, type Browser, type BrowserContextOptions, type Frame, type Page } from "playwright-core";

/** GRIDLOCK_PAGE names another build than that of ./dev build-web. */
export const PAGE_FOLDER = process.env["GRIDLOCK_PAGE"] ?? join(import.meta.dirname, "../../../build-web/page");
const CHROMIUM = process.env["GRIDLOCK_CHROMIUM"] ?? "/usr/bin/chromium";
const TYPES: Readonly<Record<string, string>> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".wasm": "application/wasm",
  ".json": "application/json",
};

/** The page's folder, or another one, by HTTP on the loopback interface. */
export async function servePage(folder = PAGE_FOLDER): Promise<{ address: string; server: Server }> {
  if (!existsSync(join(folder, "index.html"))) throw new Error(`${folder} has no page; build it with ./dev build-web`);
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent((request.url ?? "/").replace(/[?#].*$/, ""))).replace(/^\/+/, "") || "index.html";
    const file = join(folder, path);
    if (!file.startsWith(folder) || !existsSync(file) || !statSync(file).isFile()) {
      // As static hosts do.
      const other = join(folder, "404.html");
      response.writeHead(404, { "Content-Type": "text/html" }).end(existsSync(other) ? readFileSync(other) : "");
      return;
    }
    response.writeHead(200, {
      "Content-Type": TYPES[extname(file)] ?? "application/octet-stream",
      "Content-Length": statSync(file).size,
    });
    createReadStream(file).pipe(response);
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  return { address: `http://127.0.0.1:${(server.address() as AddressInfo).port}/`, server };
}

/** Pictures that do not depend on the machine. */
const SOFTWARE_RENDERING = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
/** A graphics processor, which needs no screen. */
const GRAPHICS_PROCESSOR = ["--use-angle=gl-egl"];

/** Software rendering, or a graphics processor; no traffic but that of the page. */
export async function startBrowser(rendering: "software" | "graphics processor" = "software"): Promise<Browser> {
  return chromium.launch({
    executablePath: CHROMIUM,
    args: [
      "--headless",
      "--no-sandbox",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--use-gl=angle",
      ...(rendering === "software" ? SOFTWARE_RENDERING : GRAPHICS_PROCESSOR),
      "--ignore-gpu-blocklist",
      "--force-color-profile=srgb",
      "--font-render-hinting=none",
      "--disable-lcd-text",
    ],
  });
}

/** A page, and what went wrong in it. */
export interface Watched {
  readonly page: Page;
  /** Errors and warnings of the console, and exceptions nobody has caught. */
  readonly complaints: string[];
  /** What it asked of anything but the page's own server. */
  readonly foreign: string[];
}

export async function openWatched(browser: Browser, address: string, options: BrowserContextOptions = {}): Promise<Watched> {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  const page = await context.newPage();
  const complaints: string[] = [];
  const foreign: string[] = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(address.replace(/[#?].*$/, "")) && !url.startsWith("data:") && !url.startsWith("blob:"))
      foreign.push(url);
  });
  await page.goto(address);
  return { page, complaints, foreign };
}

/** What axe-core finds wrong, in a part or all of it, for people who cannot see, hear or move as others do. */
export async function findings(page: Page | Frame, part = "html"): Promise<string[]> {
  await page.evaluate(readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"));
  const result = await page.evaluate((within) =>
    (
      globalThis as unknown as {
        axe: { run(within: string): Promise<{ violations: { id: string; impact: string; nodes: { html: string }[] }[] }> };
      }
    ).axe.run(within),
    part,
  );
  return result.violations.map(
    (one) =>
      `${one.impact} ${one.id}: ${one.nodes
        .map((node) => node.html)
        .join(" ")
        .slice(0, 300)}`,
  );
}
