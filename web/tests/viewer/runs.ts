/** Runs of the program for the tests of the viewer, and gridlock view at work. */

import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

const root = resolve(import.meta.dirname, "../../..");

/** The native program: these tests are about what it writes and serves. Throws Error where it is not built. */
export function program(): string {
  const places = [process.env["GRIDLOCK_PROGRAM"], join(root, "build/apps/gridlock/gridlock"), join(root, "build-program/apps/gridlock/gridlock")];
  const isWhole = (place: string): boolean => ["gridlock", "gridlock-view", "gridlock-show"].every((name) => existsSync(join(place, "..", name)));
  const found = places.find((place) => place !== undefined && isWhole(place));
  if (found === undefined) throw new Error("gridlock, gridlock-view and gridlock-show are not built: ./dev build, or name the program in GRIDLOCK_PROGRAM");
  return found;
}

/** The built page. Throws Error where there is none. */
export function builtPage(): string {
  const page = join(root, "build-web/page");
  if (!existsSync(join(page, "index.html"))) throw new Error("the page is not built: ./dev build-web");
  return page;
}

/** A directory that goes with the tests. */
export class Workplace {
  readonly path = mkdtempSync(join(tmpdir(), "gridlock-viewer-"));
  private readonly processes: ChildProcess[] = [];

  of(name: string): string {
    return join(this.path, name);
  }

  /** `gridlock WORDS…` in this directory, which must end well. */
  gridlock(...words: string[]): string {
    const done = spawnSync(program(), words, { cwd: this.path, encoding: "utf8" });
    if (done.status !== 0) throw new Error(`gridlock ${words.join(" ")} ends with ${done.status}: ${done.stderr}`);
    return done.stdout;
  }

  /** Runs a settings file into `results`. */
  run(toml: string, results: string): void {
    writeFileSync(this.of(`${results}.toml`), toml);
    this.gridlock("run", `${results}.toml`, "-o", results, "-q", "--no-pictures");
  }

  /** A process that goes with the tests. */
  begin(words: string[]): ChildProcess {
    const process = spawn(program(), words, { cwd: this.path, stdio: ["ignore", "pipe", "pipe"] });
    this.processes.push(process);
    return process;
  }

  /** gridlock view of a path; the address. */
  async view(path: string, ...options: string[]): Promise<string> {
    return addressOf(this.begin(["view", path, "--no-open", "--page", builtPage(), ...options]));
  }

  /** gridlock show of a file with a model in Python; the address. */
  async show(file: string, ...options: string[]): Promise<string> {
    return addressOf(this.begin(["show", file, "--no-open", ...options]));
  }

  async end(): Promise<void> {
    await Promise.all(this.processes.map(async (one) => {
      if (one.exitCode !== null || one.signalCode !== null) return;
      const ended = new Promise((resolve) => one.once("exit", resolve));
      one.kill("SIGKILL");
      await ended;
    }));
    rmSync(this.path, { recursive: true, force: true });
  }
}

/** The address that a server prints at its start. */
function addressOf(server: ChildProcess): Promise<string> {
  let printed = "";
  return new Promise((resolve, reject) => {
    server.stdout?.on("data", (text: Buffer) => {
      printed += String(text);
      const address = /http:\/\/127\.0\.0\.1:\d+\/\S*/.exec(printed)?.[0];
      if (address !== undefined) resolve(address);
    });
    server.stderr?.on("data", (text: Buffer) => { printed += String(text); });
    server.on("exit", () => reject(new Error(`${server.spawnargs.join(" ")} ended: ${printed}`)));
  });
}

export const SMALL_RUN = `disks.count = 60
disks.packing_fraction = 0.5
box.edge = "periodic"
run.steps = 60
observe.every = 10
trajectory.every = 20
`;
