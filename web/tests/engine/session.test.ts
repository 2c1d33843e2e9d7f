import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { beforeAll, describe, expect, it } from "vitest";

import { wallsIn } from "../../src/drawing/walls.ts";
import { shareOfFixed, SPECIES, withShareOfFixed } from "../../src/playground/fixed_share.ts";
import { findScene } from "../../src/playground/scenes.ts";
import { packingOf } from "../../src/sources/protocol_tables.ts";
import { Series } from "../../src/charts/series.ts";
import { GridlockError, loadGridlock, type Gridlock, type Problem } from "../../src/engine/gridlock.ts";
import { program } from "../viewer/runs.ts";

let gridlock: Gridlock;
beforeAll(async () => {
  gridlock = await loadGridlock();
});

function refusal(act: () => unknown): GridlockError {
  try {
    act();
  } catch (error) {
    if (error instanceof GridlockError) return error;
    throw error;
  }
  throw new Error("nothing was refused");
}
const problemsOf = (toml: string, ...overrides: string[]): readonly Problem[] => refusal(() => gridlock.open(toml, overrides)).problems;

describe("the series", () => {
  it("is written as the program writes series.csv, byte for byte", () => {
    const folder = mkdtempSync(join(tmpdir(), "gridlock-series-"));
    try {
      for (const toml of [
        "disks.count = 60\nrun.steps = 300\nobserve.every = 10\n",
        'disks.count = 60\nengine.kind = "exact"\nbox.edge = "periodic"\nrun.steps = 100\nobserve.every = 10\n',
        'model.kind = "epidemic"\nrun.steps = 100\nobserve.every = 10\n',
      ]) {
        writeFileSync(join(folder, "run.toml"), toml);
        const { status, stderr } = spawnSync(program(), ["run", "run.toml", "-o", "results", "-q", "--no-pictures", "--overwrite"], { cwd: folder, encoding: "utf8" });
        expect(stderr, toml).toBe("");
        expect(status).toBe(0);
        const session = gridlock.open(toml);
        session.advance(1000);
        const series = new Series(session.seriesColumns().map((column) => column.name));
        series.add(session.series());
        expect(series.toCsv()).toBe(readFileSync(join(folder, "results/series.csv"), "utf8"));
        session.dispose();
      }
    } finally {
      rmSync(folder, { recursive: true });
    }
  });
});

describe("settings that cannot be used", () => {
  it("are refused with the texts of the command line, all at once", () => {
    const problems = problemsOf("[disks]\ncont = 400\npacking_fraction = -1\n");
    expect(problems).toHaveLength(2);
    expect(problems[0]).toMatchObject({ line: 2, column: 1, sourceLine: "cont = 400", hint: "did you mean count?" });
    expect(problems[1]).toMatchObject({ line: 3, key: "disks.packing_fraction" });
    expect(problems[0]?.text).toContain("--> set-up:2:1");
  });

  it("are refused in the very words of the program", () => {
    const folder = mkdtempSync(join(tmpdir(), "gridlock-settings-"));
    try {
      for (const toml of ["[disks]\ncont = 400\npacking_fraction = -1\n", "disks.count = = 3", 'model.kind = "floking"', "engine.time_step = 5"]) {
        writeFileSync(join(folder, "set-up"), toml);
        const { stderr } = spawnSync(program(), ["check", "set-up"], { cwd: folder, encoding: "utf8" });
        const texts = problemsOf(toml).map((problem) => problem.text);
        expect(stderr.replace(/^error: /gm, "").trim()).toBe(texts.join("\n"));
      }
    } finally {
      rmSync(folder, { recursive: true });
    }
  });

  it("are refused where they are no TOML", () => {
    expect(problemsOf("disks.count = = 3")[0]).toMatchObject({ line: 1 });
    expect(problemsOf("\u0000\ud800 [")).not.toHaveLength(0);
    expect(problemsOf("a = " + "[".repeat(100_000))).not.toHaveLength(0);
  });

  it("are refused where no disks fit, where memory would not do, and where a file is asked for", () => {
    expect(problemsOf("disks.packing_fraction = 1.5")[0]?.text).toContain("packing");
    const [memory] = problemsOf("disks.count = 1_000_000_000");
    expect(memory?.what).toMatch(/would need about .* GB of memory, but .* GB are free/);
    expect(problemsOf('disks.file = "start.xyz"')[0]).toMatchObject({ line: 1, key: "disks.file" });
  });

  it("are refused where a random start would take minutes", () => {
    const [problem] = problemsOf('disks.count = 400_000\ndisks.packing_fraction = 0.54\ndisks.start = "random"\nbox.edge = "periodic"');
    expect(problem?.what).toMatch(/would take about \d+ s/);
  });

  it("leave the engine as it was", () => {
    const session = gridlock.open("disks.count = 100");
    const before = session.stateHash();
    problemsOf("disks.count = -1");
    expect(session.stateHash()).toBe(before);
    expect(session.advance(10)).toBe(10);
    session.dispose();
  });
});

describe("the settings", () => {
  it("are described with bounds, defaults and choices", () => {
    const settings = new Map(gridlock.settings().map((setting) => [setting.key, setting]));
    expect(settings.get("disks.packing_fraction")).toMatchObject({ kind: "number", least: 0, most: 2, leastIsAllowed: false });
    expect(settings.get("engine.kind")).toMatchObject({ kind: "choice", default: "stepped", choices: ["stepped", "tiled", "exact", "event_chain", "soft"] });
    expect(settings.get("model.kind")?.choices).toContain("flocking");
    expect(settings.get("disks.start")?.choices).toContain("triangular");
    expect(settings.get("protocol[].stage")?.choices).toContain("quench");
    expect(gridlock.models().map((model) => model.name)).toContain("epidemic");
    expect(gridlock.engines().map((engine) => engine.name)).toEqual(["stepped", "tiled", "exact", "event_chain", "soft"]);
  });

  it("are read and merged without setting up a run", () => {
    const toml = "# a comment\n[disks]\ncount = 1_000_000_000\n[[protocol]]\nstage = \"quench\"\npacking_fraction = 0.86\n";
    expect(gridlock.read(toml, ["disks.start=square"])).toMatchObject({ "disks.count": 1e9, "disks.start": "square", protocol: 1 });
    const merged = gridlock.merge(toml, ["engine.kind=exact"]);
    expect(merged).toContain("disks.count = 1000000000\n");
    expect(merged).toContain('engine.kind = "exact"\n');
    expect(gridlock.read(merged)).toEqual(gridlock.read(toml, ["engine.kind=exact"]));
  });
});

describe("the scene of a hopper", () => {
  const toml = findScene("hopper")?.toml ?? "";
  const walls = [
    { from: { x: 0, y: 18 }, to: { x: 8.4, y: 10 } },
    { from: { x: 20, y: 18 }, to: { x: 11.6, y: 10 } },
  ];

  it("keeps its walls where other settings are changed, in the run and in the link", () => {
    for (const change of [[], ["collisions.restitution=0.5", "gravity.y=-3"], ["box.edge_x=periodic", "disks.count=200"]]) {
      const session = gridlock.open(toml, change);
      expect(wallsIn(session.configuration())).toEqual(walls);
      session.dispose();
      const linked = gridlock.open(gridlock.merge(toml, change));
      expect(wallsIn(linked.configuration())).toEqual(walls);
      linked.dispose();
    }
  });

  it("gets as many fixed disks as the slider says, beside any other change", () => {
    let values = gridlock.read(toml);
    for (const share of [0.25, 0, 0.1]) {
      const change = [`${SPECIES}=${withShareOfFixed(values, share)}`, "gravity.y=-3"];
      const session = gridlock.open(gridlock.merge(toml, change));
      const masses = Array.from(session.column("mass"), Number);
      expect(masses.filter((mass) => mass === Infinity).length).toBe(300 * share);
      values = session.values();
      expect(shareOfFixed(values)).toBeCloseTo(share, 12);
      session.advance(3);
      session.dispose();
    }
  });
});

describe("a session", () => {
  it("samples as the command line does, wherever it is cut", () => {
    const toml = "disks.count = 100\nrun.steps = 100\nobserve.every = 20\nobserve.structure_every = 1";
    const whole = gridlock.open(toml);
    whole.advance(Number.MAX_SAFE_INTEGER);
    const pieces = gridlock.open(toml);
    while (!pieces.isFinished) pieces.advance(7);
    const width = whole.seriesColumns().length;
    expect(whole.seriesLength).toBe(6);
    expect(whole.series()).toHaveLength(6 * width);
    expect(pieces.series()).toEqual(whole.series());
    expect(whole.series(5)).toEqual(whole.series().slice(5 * width));
    expect(whole.seriesColumns().map((column) => column.name)).toEqual(expect.arrayContaining(["step", "time", "mean_displacement", "wall_pressure"]));
    expect(whole.results().find((result) => result.name === "mean_displacement")?.mean).toBeGreaterThan(0);
    whole.dispose();
    pieces.dispose();
  });

  it("goes on behind its end when it is lengthened", () => {
    const session = gridlock.open("disks.count = 100\nrun.steps = 50");
    expect(session.endStep).toBe(50);
    expect(session.advance(80)).toBe(50);
    expect(session.isFinished).toBe(true);
    expect(session.advance(80)).toBe(0);
    session.lengthen();
    expect(session.endStep).toBe(Infinity);
    expect(session.advance(30)).toBe(30);
    const longer = gridlock.open("disks.count = 100\nrun.steps = 80");
    longer.advance(80);
    expect(session.stateHash()).toBe(longer.stateHash());
    session.dispose();
    longer.dispose();
  });

  it("keeps to its time", () => {
    const session = gridlock.open('disks.count = 10_000\nengine.kind = "exact"\ndisks.packing_fraction = 0.7\ndisks.start = "triangular"');
    const begin = performance.now();
    session.advance(1_000_000, 30);
    expect(performance.now() - begin).toBeLessThan(500);
    session.dispose();
  });

  it("gives columns in the order of the ids", () => {
    const session = gridlock.open('disks.count = 2000\nengine.kind = "tiled"');
    session.advance(20);
    const ids = session.ids();
    expect([...ids]).toEqual([...ids.keys()]);
    const [x, y] = [session.column("x") as Float64Array, session.column("y") as Float64Array];
    expect(session.positions()[2 * 17]).toBe(Math.fround(x[17] as number));
    expect(session.positions()[2 * 17 + 1]).toBe(Math.fround(y[17] as number));
    expect(session.radii()).toHaveLength(2000);
    expect(session.column("image_x")).toBeInstanceOf(Int32Array);
    expect(session.drawnColumns().map((column) => column.name)).toEqual(expect.arrayContaining(["displacement", "psi6", "speed", "mass"]));
    for (const { name } of session.drawnColumns()) expect(session.drawnColumn(name)).toHaveLength(2000);
    expect(refusal(() => session.column("mood")).problems[0]?.hint).toContain("velocity_x");
    session.dispose();
  });

  it("knows the block of cells around an agent and who is in it", () => {
    const session = gridlock.open('disks.count = 400\nbox.edge = "periodic"');
    const { columns, rows, cellWidth } = session.grid();
    const radius = session.radii()[0] as number;
    expect(columns).toBe(Math.floor(1 / (2 * radius)));
    expect(rows).toBe(columns);
    expect(cellWidth).toBeCloseTo(1 / columns);
    const { cell, cells, ids, near } = session.neighbourhood(7);
    expect(cells).toHaveLength(9);
    expect(cells).toContain(cell);
    expect(ids).not.toContain(7);
    expect(ids).toEqual(expect.arrayContaining([...near]));
    expect(refusal(() => session.neighbourhood(400)).message).toContain("no agent 400");
    session.dispose();
  });

  it("carries out a protocol and shows the contacts of the packing", () => {
    const session = gridlock.open(
      'disks.count = 64\ndisks.start = "uniform"\nbox.edge = "periodic"\n[[protocol]]\nstage = "quench"\npacking_fraction = 0.88\n',
    );
    expect(session.isPrepared).toBe(false);
    expect(session.preparation.what).toBe("quench");
    while (!session.isPrepared) session.advance(0, 5);
    expect(session.isFinished).toBe(true);
    const { ids, forces } = session.contacts();
    expect(ids).toHaveLength(2 * forces.length);
    expect(forces.length).toBeGreaterThan(64);
    session.dispose();
  });

  it("has the tables of its protocol as the program writes them, stage by stage", () => {
    const folder = mkdtempSync(join(tmpdir(), "gridlock-stages-"));
    const decompressed =
      'disks.count = 36\ndisks.start = "uniform"\nbox.edge = "periodic"\nbox.width = 1.5\nbox.height = 0.8\n' +
      '[[protocol]]\nstage = "quench"\npacking_fraction = 0.9\n[[protocol]]\nstage = "decompress"\nuntil_pressure = 1e-4\n';
    const sheared = findScene("shear")?.toml ?? "";
    try {
      for (const [name, toml] of Object.entries({ decompressed, sheared })) {
        writeFileSync(join(folder, "run.toml"), toml);
        const { status } = spawnSync(program(), ["run", "run.toml", "-o", name, "-q", "--no-pictures"], { cwd: folder });
        expect(status).toBe(0);
        const written = (file: string): string => (existsSync(join(folder, name, file)) ? readFileSync(join(folder, name, file), "utf8") : "");
        const expected = packingOf(written("stages.csv"), written("levels.csv"), written("summary.json"), written("shear.csv"));
        const session = gridlock.open(toml);
        expect(session.protocolTables()).toEqual({});
        while (!session.isPrepared) session.advance(0, 5);
        const { stages, levels, shear = { names: [], columns: {} } } = session.protocolTables();
        expect({ stages, levels, shear, results: session.results().map(({ name, mean, standardError }) => ({ name, mean, standardError })) }).toEqual(expected);
        expect(stages?.names).toEqual(["quench", name === "sheared" ? "shear" : "decompress"]);
        session.dispose();
      }
    } finally {
      rmSync(folder, { recursive: true });
    }
  });

  it("shears its box in a protocol, and finds neighbours across the shifted edges", () => {
    const session = gridlock.open(findScene("shear")?.toml ?? "");
    const start = session.save();
    expect(session.box).toEqual({ width: 1, height: 1, periodic: true, shift: 0 });
    while (!session.isPrepared) session.advance(0, 50);
    expect(session.box).toEqual({ width: 1, height: 1, periodic: true, shift: 0.2 });
    const { ids, forces } = session.contacts();
    expect(forces.length).toBeGreaterThan(100);
    const near = Array.from({ length: session.count }, (_, id) => session.neighbourhood(id).near);
    forces.forEach((_, i) => expect(near[ids[2 * i] as number]).toContain(ids[2 * i + 1]));
    session.restore(start);
    expect(session.box.shift).toBe(0);
    session.dispose();
  });

  it("refuses to restore what is of another session, and stays as it was", () => {
    const session = gridlock.open("disks.count = 100");
    const other = gridlock.open("disks.count = 101");
    session.advance(10);
    const before = session.stateHash();
    expect(refusal(() => session.restore(other.save())).kind).toBe("input");
    expect(refusal(() => session.restore(new Uint8Array([1, 2, 3]))).kind).toBe("input");
    const bytes = session.save();
    bytes[bytes.length >> 1] = 1 + (bytes[bytes.length >> 1] ?? 0);
    expect(refusal(() => session.restore(bytes)).kind).toBe("input");
    expect(session.stateHash()).toBe(before);
    expect(session.advance(10)).toBe(10);
    session.dispose();
    other.dispose();
  });

  it("says that memory does not do, and another one is opened all the same", () => {
    const sessions = [];
    let error: GridlockError | undefined;
    while (error === undefined && sessions.length < 40) {
      try {
        sessions.push(gridlock.open('disks.count = 2_000_000\ndisks.start = "square"'));
      } catch (caught) {
        error = caught as GridlockError;
      }
    }
    expect(error?.name).toBe("GridlockError");
    expect(error?.message).toMatch(/memory/);
    for (const session of sessions) session.dispose();
    const session = gridlock.open("disks.count = 100");
    expect(session.advance(10)).toBe(10);
    session.dispose();
  });
});
