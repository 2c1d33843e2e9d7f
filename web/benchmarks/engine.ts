/**
 * The speed of the engines as WebAssembly, in Node and in Chromium, beside the program built for this machine without wide
 * registers (GRIDLOCK_TARGET=scalar), all on one thread: the same set-ups, run in turns, with the same state hash at the end.
 *
 *     ./dev build-web && ./dev build
 *     build-web/environment/bin/node web/benchmarks/engine.ts        writes benchmarks/results/web.csv
 */

import { execFileSync } from "node:child_process";
import { createReadStream, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { cpus, tmpdir } from "node:os";
import { join } from "node:path";

import { chromium, type Browser, type Page } from "playwright-core";

const root = join(import.meta.dirname, "../..");
const program = join(root, "build/apps/gridlock/gridlock");
const engineFolder = join(root, "build-web/engine/web/engine");
const TURNS = 5;

const disks = (count: number, engine: string, steps: number): string =>
  `disks.count = ${count}\ndisks.packing_fraction = 0.7\ndisks.start = "triangular"\nbox.edge = "periodic"\n` +
  `engine.kind = "${engine}"\nrun.steps = ${steps}\nobserve.every = 1000000\n`;
const scene = (name: string, steps: number): string =>
  `${readFileSync(join(root, "scenes", `${name}.toml`), "utf8").replace(/^steps = .*$/m, `steps = ${steps}`)}`;

const setups: Readonly<Record<string, string>> = {
  "stepped, 841 disks": disks(841, "stepped", 2000),
  "stepped, 10000 disks": disks(10_000, "stepped", 150),
  "tiled, 841 disks": disks(841, "tiled", 2000),
  "tiled, 10000 disks": disks(10_000, "tiled", 150),
  "exact, 841 disks": disks(841, "exact", 300),
  "exact, 10000 disks": disks(10_000, "exact", 25),
  "scenes/flocking.toml": scene("flocking", 1000),
  "scenes/epidemic.toml": scene("epidemic", 1000),
  "scenes/catalyst.toml": scene("catalyst", 500),
};

interface Outcome {
  seconds: number;
  hash: string;
}

/** Runs in Node and in the page: loads the module, and runs a set-up to its end. */
async function runEngine(address: string, wasm: Uint8Array, toml: string): Promise<Outcome> {
  const { default: createEngine } = (await import(address)) as { default: (options: object) => Promise<any> };
  const engine = await createEngine({ wasmBinary: wasm });
  const session = engine.open(toml, []).value;
  const begin = performance.now();
  session.advance(Number.MAX_SAFE_INTEGER, 1e9);
  const seconds = (performance.now() - begin) / 1000;
  const hash = session.stateHash().value;
  session.delete();
  return { seconds, hash };
}

function inProgram(toml: string): Outcome {
  const folder = mkdtempSync(join(tmpdir(), "gridlock-benchmark-"));
  try {
    writeFileSync(join(folder, "setup.toml"), toml + "\n[checkpoint]\nkeep_last = false\n");
    execFileSync(program, ["run", "setup.toml", "-j", "1", "--no-pictures", "-o", "run"], {
      cwd: folder,
      env: { ...process.env, GRIDLOCK_TARGET: "scalar" },
      stdio: "pipe",
    });
    const summary = JSON.parse(readFileSync(join(folder, "run/summary.json"), "utf8"));
    return { seconds: summary.timing.seconds, hash: summary.state_hash };
  } finally {
    rmSync(folder, { recursive: true });
  }
}

async function serveEngine(): Promise<{ server: Server; address: string }> {
  const server = createServer((request, response) => {
    if (request.url === "/") {
      response.writeHead(200, { "Content-Type": "text/html" }).end("<!doctype html>");
      return;
    }
    const name = request.url === "/gridlock_engine.js" ? "gridlock_engine.js" : "gridlock_engine.wasm";
    response.writeHead(200, { "Content-Type": name.endsWith("js") ? "text/javascript" : "application/wasm" });
    createReadStream(join(engineFolder, name)).pipe(response);
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  return { server, address: `http://127.0.0.1:${(server.address() as AddressInfo).port}/` };
}

async function inPage(page: Page, toml: string): Promise<Outcome> {
  const script = `(async () => {
    const run = ${runEngine.toString()};
    const wasm = new Uint8Array(await (await fetch("/gridlock_engine.wasm")).arrayBuffer());
    return run("/gridlock_engine.js", wasm, ${JSON.stringify(toml)});
  })()`;
  return page.evaluate<Outcome>(script);
}

const median = (numbers: readonly number[]): number => [...numbers].sort((a, b) => a - b)[numbers.length >> 1] as number;

async function measure(name: string, toml: string, page: Page): Promise<string> {
  const wasm = readFileSync(join(engineFolder, "gridlock_engine.wasm"));
  const times: Record<"program" | "node" | "chromium", number[]> = { program: [], node: [], chromium: [] };
  const hashes = new Set<string>();
  const note = (where: keyof typeof times, outcome: Outcome): void => {
    times[where].push(outcome.seconds);
    hashes.add(outcome.hash);
  };
  for (let turn = 0; turn < TURNS; ++turn) {
    note("program", inProgram(toml));
    note("node", await runEngine(join(engineFolder, "gridlock_engine.js"), wasm, toml));
    note("chromium", await inPage(page, toml));
  }
  if (hashes.size !== 1) throw new Error(`${name}: the state hashes differ: ${[...hashes].join(", ")}`);
  const [program_, node, chromium_] = [median(times.program), median(times.node), median(times.chromium)];
  const numbers = [program_, node, chromium_].map((seconds) => seconds.toFixed(4));
  return `"${name}",${numbers.join(",")},${(node / program_).toFixed(2)},${(chromium_ / program_).toFixed(2)},${[...hashes].join("")}`;
}

async function main(browser: Browser): Promise<void> {
  const { server, address } = await serveEngine();
  try {
    const page = await browser.newPage();
    await page.goto(address);
    const lines = [
      `# ${cpus()[0]?.model}; median of ${TURNS} runs in turns, one thread; GRIDLOCK_TARGET=scalar for the program; Node ${process.version}, Chromium ${browser.version()}`,
      "setup,program_seconds,node_seconds,chromium_seconds,node_ratio,chromium_ratio,state_hash",
    ];
    for (const line of lines) console.log(line);
    for (const [name, toml] of Object.entries(setups)) {
      lines.push(await measure(name, toml, page));
      console.log(lines.at(-1));
    }
    writeFileSync(join(root, "benchmarks/results/web.csv"), lines.join("\n") + "\n");
  } finally {
    server.close();
  }
}

const browser = await chromium.launch({
  executablePath: process.env["GRIDLOCK_CHROMIUM"] ?? "/usr/bin/chromium",
  args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
try {
  await main(browser);
} finally {
  await browser.close();
}
