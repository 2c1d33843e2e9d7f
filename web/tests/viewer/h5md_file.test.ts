import { readFileSync, writeFileSync } from "node:fs";
import { File, ready } from "h5wasm/node";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { H5mdFile, useHdf5 } from "../../src/sources/h5md_file.ts";
import { surround } from "../../src/sources/xyz_file.ts";
import { SMALL_RUN, Workplace } from "./runs.ts";

let place: Workplace;

beforeAll(async () => {
  useHdf5(await ready);
  place = new Workplace();
  place.run(SMALL_RUN, "results");
  place.gridlock("export", "results", "--to", "csv", "-o", "frames.csv");
});
afterAll(() => place.end());

const opened = (path: string): H5mdFile => new H5mdFile("file.h5", new File(path, "r") as never);

describe("A trajectory of Gridlock", () => {
  test("has the frames and columns that the library reads", async () => {
    const file = opened(place.of("results/trajectory.h5"));
    expect(file.description.agents).toBe("disks");
    expect(file.description.steps).toEqual([0, 20, 40, 60]);
    const [head, ...lines] = readFileSync(place.of("frames.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
    expect(file.description.columns).toEqual((head as string[]).slice(3));
    for (let index = 0; index < 4; ++index) {
      const frame = await file.frame(index);
      const rows = lines.filter((cells) => Number(cells[0]) === frame.step);
      expect(rows.length).toBe(60);
      expect([...frame.ids]).toEqual(rows.map((cells) => Number(cells[2])));
      for (const [at, name] of (head as string[]).entries()) {
        if (at >= 3) expect(Array.from(frame.columns[name] as ArrayLike<number>, Number), name).toEqual(rows.map((cells) => Number(cells[at])));
      }
      expect(frame.box).toEqual({ width: 1, height: 1, periodic: true });
    }
  });

  test("has the state hash of each frame and the observables", async () => {
    const file = opened(place.of("results/trajectory.h5"));
    const summary = JSON.parse(readFileSync(place.of("results/summary.json"), "utf8")) as { state_hash: string };
    expect((await file.frame(3)).stateHash).toBe(summary.state_hash);
    const displacement = file.description.table.quantities.find((one) => one.name === "mean_displacement");
    expect(displacement?.values.length).toBe(4);
    expect(displacement?.values[0]).toBe(0);
    expect(displacement?.unit).toBe("sides of the box");
  });

  test("has the walls inside the box that the settings in it have", () => {
    place.run(`${SMALL_RUN.replace('"periodic"', '"wall"')}engine.kind = "exact"\nwalls = [{ from = [0.0, 0.0], to = [0.01, 0.01] }]\n`, "walled");
    expect(opened(place.of("walled/trajectory.h5")).description.walls).toEqual([{ from: { x: 0, y: 0 }, to: { x: 0.01, y: 0.01 } }]);
    expect(opened(place.of("results/trajectory.h5")).description.walls).toEqual([]);
  });

  test("of agents that come and go has those that are there", async () => {
    place.run(`model.kind = "epidemic"\n[epidemic]\ncount = 40\nturnover_rate = 5.0\n[run]\nsteps = 40\n[trajectory]\nevery = 10\n`, "town");
    place.gridlock("export", "town", "--to", "csv", "-o", "town.csv");
    const counts = new Map<number, number>();
    for (const line of readFileSync(place.of("town.csv"), "utf8").trim().split("\n").slice(1)) {
      const step = Number(line.split(",")[0]);
      counts.set(step, (counts.get(step) ?? 0) + 1);
    }
    const file = opened(place.of("town/trajectory.h5"));
    expect(file.description.valueNames).toEqual({ health: ["susceptible", "infected", "recovered"] });
    expect(new Set(counts.values()).size).toBeGreaterThan(1);
    for (const [index, step] of file.description.steps.entries()) {
      const frame = await file.frame(index);
      expect(frame.ids.length).toBe(counts.get(step));
      expect(frame.columns["health"]?.length).toBe(counts.get(step));
    }
  });
});

describe("A damaged file", () => {
  test("is refused in words, wherever it is cut", () => {
    const bytes = readFileSync(place.of("results/trajectory.h5"));
    for (const share of [0.01, 0.1, 0.5, 0.9]) {
      writeFileSync(place.of("cut.h5"), bytes.subarray(0, Math.floor(share * bytes.length)));
      expect(() => opened(place.of("cut.h5")), `${share} of it`).toThrow(/./);
    }
  });

  test("of another kind says that it is no trajectory", () => {
    const other = new File(place.of("other.h5"), "w");
    other.create_dataset({ name: "numbers", data: new Float64Array([1, 2, 3]) });
    other.close();
    expect(() => opened(place.of("other.h5"))).toThrow("file.h5 cannot be shown: it is no trajectory in H5MD: it has no positions under /particles.");
  });

  test("names the frame whose numbers are damaged", async () => {
    const bytes = readFileSync(place.of("results/trajectory.h5"));
    // A chunk of deflated numbers begins with 0x78 0x01 at compression 1; the last one of x belongs to a late frame.
    const file = opened(place.of("results/trajectory.h5"));
    let damaged = 0;
    for (let at = bytes.length - 1; at > 0 && damaged < 60; --at) {
      if (bytes[at] === 0x78 && (bytes[at + 1] === 0x01 || bytes[at + 1] === 0x5e)) {
        bytes.fill(0xff, at + 2, at + 12);
        ++damaged;
      }
    }
    expect(damaged).toBeGreaterThan(10);
    writeFileSync(place.of("damaged.h5"), bytes);
    const outcomes = await Promise.allSettled(file.description.steps.map((_, index) => opened(place.of("damaged.h5")).frame(index)));
    const refusals = outcomes.flatMap((one) => (one.status === "rejected" ? [String(one.reason)] : []));
    expect(refusals.length).toBeGreaterThan(0);
    for (const refusal of refusals) expect(refusal).toMatch(/frame \d is damaged/);
  });
});

describe("A trajectory of another program", () => {
  const write = (path: string, fill: (file: File) => void): void => {
    const file = new File(path, "w");
    for (const group of ["particles", "particles/all", "particles/all/box", "particles/all/position"]) file.create_group(group);
    fill(file);
    file.close();
  };
  const positions = { data: new Float32Array([0.5, 1.5, 0, -0.25, 2.5, 0, 1.5, 1.75, 0, 3, 2, 0]), shape: [2, 2, 3] };

  test("may have fixed edges, evenly spaced frames and a fixed column", async () => {
    write(place.of("fixed.h5"), (file) => {
      const box = file.get("particles/all/box") as never as { create_attribute(name: string, data: unknown): void };
      box.create_attribute("boundary", ["periodic", "periodic", "none"]);
      file.create_dataset({ name: "particles/all/box/edges", data: new Float64Array([2, 3, 1]) });
      file.create_dataset({ name: "particles/all/position/value", ...positions });
      file.create_dataset({ name: "particles/all/position/step", data: new Int32Array([100]), shape: [] });
      file.create_dataset({ name: "particles/all/position/time", data: new Float64Array([0.25]), shape: [] });
      file.create_dataset({ name: "particles/all/species", data: new Int32Array([1, 2]) });
    });
    const file = opened(place.of("fixed.h5"));
    expect(file.description.steps).toEqual([0, 100]);
    expect(file.description.times).toEqual([0, 0.25]);
    const frame = await file.frame(0);
    expect(frame.box).toEqual({ width: 2, height: 3, periodic: true });
    expect([...frame.ids]).toEqual([0, 1]);
    expect(Array.from(frame.columns["x"] as ArrayLike<number>)).toEqual([0.5, 1.75]); // −0.25 in a box of 2
    expect(Array.from(frame.columns["species"] as ArrayLike<number>)).toEqual([1, 2]);
  });

  test("may have fields, of which those of several cells in all frames are shown", async () => {
    write(place.of("fields.h5"), (file) => {
      file.create_dataset({ name: "particles/all/position/value", ...positions });
      file.create_group("fields");
      for (const [name, shape] of [["grass", [2, 2, 3]], ["price", [2, 1, 1]], ["late", [1, 2, 3]]] as [string, number[]][]) {
        file.create_group(`fields/${name}`);
        const count = shape.reduce((product, size) => product * size, 1);
        file.create_dataset({ name: `fields/${name}/value`, data: Float64Array.from({ length: count }, (_, at) => at), shape });
      }
    });
    const file = opened(place.of("fields.h5"));
    expect(file.description.fields).toEqual(["grass"]);
    expect((await file.frame(1)).fields).toEqual({ grass: { rows: 2, columns: 3, values: Float64Array.from([6, 7, 8, 9, 10, 11]) } });
  });

  test("may have its edges as vectors, and steps and times that begin anywhere", async () => {
    for (const [edges, shape] of [[[2, 0, 0, 3], [2, 2]], [[2, 0, 0, 0, 3, 0, 0, 0, 1], [3, 3]]] as const) {
      const path = place.of(`vectors_${shape[0]}.h5`);
      write(path, (file) => {
        file.create_dataset({ name: "particles/all/box/edges", data: Float64Array.from(edges), shape: [...shape] });
        file.create_dataset({ name: "particles/all/position/value", ...positions });
        file.create_dataset({ name: "particles/all/position/step", data: new Int32Array([100]), shape: [] });
        file.create_dataset({ name: "particles/all/position/time", data: new Float64Array([0.25]), shape: [] });
        const offset = (name: string, value: number): void => (file.get(`particles/all/position/${name}`) as never as {
          create_attribute(name: string, data: unknown): void }).create_attribute("offset", value);
        offset("step", 5000);
        offset("time", 12.5);
      });
      const file = opened(path);
      expect((await file.frame(0)).box).toEqual({ width: 2, height: 3, periodic: false });
      expect(file.description.steps).toEqual([5000, 5100]);
      expect(file.description.times).toEqual([12.5, 12.75]);
    }
  });

  test("with several groups of agents shows the first, and a note names the others", async () => {
    write(place.of("groups.h5"), (file) => {
      file.create_dataset({ name: "particles/all/position/value", ...positions });
      for (const group of ["particles/walls", "particles/walls/position", "particles/empty"]) file.create_group(group);
      file.create_dataset({ name: "particles/walls/position/value", ...positions });
    });
    const { agents, notes } = opened(place.of("groups.h5")).description;
    expect(agents).toBe("all");
    expect(notes).toEqual(["The file also has walls; of several groups of agents the first is shown."]);
  });

  test("without a box gets the rectangle around its agents", async () => {
    write(place.of("boxless.h5"), (file) => {
      file.create_dataset({ name: "particles/all/position/value", ...positions });
    });
    const { box, columns } = await opened(place.of("boxless.h5")).frame(0);
    expect(box.periodic).toBe(false);
    for (const [name, side] of [["x", box.width], ["y", box.height]] as const) {
      for (const value of columns[name] as Float64Array) {
        expect(value).toBeGreaterThan(0);
        expect(value).toBeLessThan(side);
      }
    }
  });

  test("without a box has as much room on every side, whichever way its agents lie", () => {
    for (const [width, height] of [[4, 0], [0, 4], [4, 1], [1, 4]] as const) {
      const [x, y] = [Float64Array.of(-1, -1 + width), Float64Array.of(7, 7 + height)];
      const box = surround(x, y);
      expect([box.width, box.height]).toEqual([width + 0.16, height + 0.16]);
      expect([...x, ...y].map((value) => Number(value.toFixed(9)))).toEqual([0.08, width + 0.08, 0.08, height + 0.08]);
    }
  });

  test("in a box that is periodic in one direction is folded in that one alone", async () => {
    for (const [boundary, expected] of [[["periodic", "none", "none"], [1.75, 3.5]], [["none", "periodic", "none"], [-0.25, 0.5]]] as const) {
      const path = place.of(`${boundary[0]}_in_x.h5`);
      write(path, (file) => {
        const box = file.get("particles/all/box") as never as { create_attribute(name: string, data: unknown): void };
        box.create_attribute("boundary", boundary);
        file.create_dataset({ name: "particles/all/box/edges", data: new Float64Array([2, 3, 1]) });
        file.create_dataset({ name: "particles/all/position/value", data: new Float64Array([-0.25, 3.5, 0]), shape: [1, 1, 3] });
        file.create_dataset({ name: "particles/all/position/step", data: new Int32Array([70]), shape: [1] });
      });
      const file = opened(path);
      expect(file.description.notes).toEqual([]);
      expect(file.description.times).toEqual([70]); // without times the steps are the clock
      const { box, columns } = await file.frame(0);
      expect(box).toEqual({ width: 2, height: 3, periodic: [boundary[0] === "periodic", boundary[1] === "periodic"] });
      expect([...(columns["x"] as Float64Array), ...(columns["y"] as Float64Array)]).toEqual(expected);
    }
  });

  test("in an oblique box is folded to the left across the upper edge, and its shift is at most half a width", async () => {
    // (0.25, 3.5) is the image of (0.25 − shift, 0.5).
    for (const [xy, shift, x] of [[0.5, 0.5, 1.75], [1.5, -0.5, 0.75], [-2.25, -0.25, 0.5]] as const) {
      const path = place.of(`oblique${xy}.h5`);
      write(path, (file) => {
        const box = file.get("particles/all/box") as never as { create_attribute(name: string, data: unknown): void };
        box.create_attribute("boundary", ["periodic", "periodic", "none"]);
        file.create_dataset({ name: "particles/all/position/value", data: new Float64Array([0.25, 3.5, 0]), shape: [1, 1, 3] });
        file.create_dataset({ name: "particles/all/position/step", data: new Int32Array([70]), shape: [1] });
        file.create_dataset({ name: "particles/all/box/edges", data: new Float64Array([2, 0, 0, xy, 3, 0, 0, 0, 1]), shape: [3, 3] });
      });
      const { box, columns } = await opened(path).frame(0);
      expect(box).toEqual({ width: 2, height: 3, periodic: true, shift });
      expect([columns["x"]?.[0], columns["y"]?.[0]]).toEqual([x, 0.5]);
    }
  });

  test("in an oblique box with walls is refused, and in one whose first edge is not along x", async () => {
    const edges: [string, number[], string][] = [["walls", [2, 0, 0, 0.5, 3, 0, 0, 0, 1], "its box is oblique and has walls"], ["turned", [2, 0.5, 0, 0, 3, 0, 0, 0, 1], "the first edge of its box is (2, 0.5)"]];
    for (const [name, data, message] of edges) {
      write(place.of(`${name}.h5`), (file) => {
        file.create_dataset({ name: "particles/all/position/value", ...positions });
        file.create_dataset({ name: "particles/all/box/edges", data: new Float64Array(data), shape: [3, 3] });
      });
      await expect(opened(place.of(`${name}.h5`)).frame(0)).rejects.toThrow(message);
    }
  });
});
