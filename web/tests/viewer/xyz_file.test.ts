import { readFileSync } from "node:fs";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { BlobBytes, type Bytes } from "../../src/sources/bytes.ts";
import { XyzFile } from "../../src/sources/xyz_file.ts";
import { SMALL_RUN, Workplace } from "./runs.ts";

const bytesOf = (text: string): Bytes => new BlobBytes("file.xyz", new Blob([text]));
const open = (text: string): Promise<XyzFile> => XyzFile.open(bytesOf(text));

const TWO_FRAMES = `2
Lattice="2 0 0 0 3 0 0 0 1" pbc="T T F" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3 Time=0.5 step=10
B 0.5 1 0 7 1 2 0
A 1.5 2 0 3 -1 0.25 0
2
Lattice="2 0 0 0 3 0 0 0 1" pbc="T T F" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3 Time=1.0 step=20
B 2.5 -1 0 7 1 2 0
A 1.5 2 0 3 -1 0.25 0
`;

describe("Extended XYZ", () => {
  test("has columns by name, and positions in the box", async () => {
    const file = await open(TWO_FRAMES);
    expect(file.description.steps).toEqual([10, 20]);
    expect(file.description.times).toEqual([0.5, 1]);
    expect(file.description.columns).toEqual(["species", "x", "y", "velocity_x", "velocity_y"]);
    const frame = await file.frame(1);
    expect(frame.box).toEqual({ width: 2, height: 3, periodic: true });
    expect([...frame.ids]).toEqual([7, 3]);
    expect(Array.from(frame.columns["x"] as ArrayLike<number>)).toEqual([0.5, 1.5]);
    expect(Array.from(frame.columns["y"] as ArrayLike<number>)).toEqual([2, 2]);
    expect(Array.from(frame.columns["velocity_y"] as ArrayLike<number>)).toEqual([2, 0.25]);
    expect(Array.from(frame.columns["species"] as ArrayLike<number>)).toEqual([1, 0]);
  });

  test("is read the same whatever pieces it comes in", async () => {
    const whole = await (await open(TWO_FRAMES)).frame(1);
    const data = new TextEncoder().encode(TWO_FRAMES);
    const pieces: Bytes = { name: "file.xyz", size: data.length, read: async (offset, length) => data.subarray(offset, offset + Math.min(length, length > 1000 ? 7 : length)) };
    const file = await XyzFile.open(pieces);
    expect(file.description.steps).toEqual([10, 20]);
    expect(await file.frame(1)).toEqual(whole);
  });

  test("with the ends of lines of Windows and without a last one is the same", async () => {
    const windows = await open(TWO_FRAMES.replaceAll("\n", "\r\n").trimEnd());
    expect(await windows.frame(1)).toEqual(await (await open(TWO_FRAMES)).frame(1));
  });

  test("without a lattice gets the rectangle around its agents", async () => {
    const frame = await (await open("3\nplain\nH 10 20\nH 14 20\nO 12 22\n")).frame(0);
    expect(frame.box.periodic).toBe(false);
    expect(frame.box.width).toBeCloseTo(4.16);
    const x = Array.from(frame.columns["x"] as ArrayLike<number>);
    expect((x[1] as number) - (x[0] as number)).toBeCloseTo(4);
    expect(Math.min(...x)).toBeGreaterThan(0);
  });

  test("counts from its origin, and keeps agents outside walls where they are", async () => {
    const frame = await (await open('1\nLattice="4 0 0 0 4 0 0 0 1" Origin="-2 -2 0" pbc="F F F" Properties=pos:R:2\n-1 3\n')).frame(0);
    expect(Array.from(frame.columns["x"] as ArrayLike<number>)).toEqual([1]);
    expect(Array.from(frame.columns["y"] as ArrayLike<number>)).toEqual([5]);
  });

  test("is folded along the axis that is periodic alone", async () => {
    const frame = await (await open('1\nLattice="4 0 0 0 3 0 0 0 1" pbc="F T F" Properties=pos:R:2\n-1 -1\n')).frame(0);
    expect(frame.box).toEqual({ width: 4, height: 3, periodic: [false, true] });
    expect([frame.columns["x"], frame.columns["y"]].map((values) => (values as ArrayLike<number>)[0])).toEqual([-1, 2]);
  });

  test("in an oblique box is folded to the left across the upper edge, and its shift is at most half a width", async () => {
    const row = "Properties=pos:R:2:image_x:I:1:image_y:I:1\n0.25 3.5 0 1\n";
    const of = async (xy: number): Promise<unknown> => {
      const { box, columns } = await (await open(`1\nLattice="2 0 0 ${xy} 3 0 0 0 1" pbc="T T F" ${row}`)).frame(0);
      return [box, ...["x", "y", "image_x"].map((name) => columns[name]?.[0])];
    };
    const box = { width: 2, height: 3, periodic: true };
    expect(await of(0.5)).toEqual([{ ...box, shift: 0.5 }, 1.75, 0.5, 0]);
    // The image one box above is 1.5 = 2 − 0.5 farther to the right: an edge of x more in a box that leans by −0.5.
    expect(await of(1.5)).toEqual([{ ...box, shift: -0.5 }, 0.75, 0.5, 1]);
    expect(await of(0)).toEqual([box, 0.25, 0.5, 0]);
  });

  test("has the names of other programs, and words in their order", async () => {
    const frame = await (await open("2\nProperties=masses:R:1:momenta:R:3:pos:R:2:diameter:R:1:tag:S:1:on:L:1\n2 3 -1 0 1 2 0.5 b T\n4 2 2 0 3 4 1 a F\n")).frame(0);
    const of = (name: string): number[] => Array.from(frame.columns[name] as ArrayLike<number>);
    expect(Object.keys(frame.columns)).toEqual(["mass", "velocity_x", "velocity_y", "x", "y", "radius", "tag", "on"]);
    expect([of("velocity_x"), of("velocity_y"), of("radius"), of("tag"), of("on")]).toEqual([[1.5, 0.5], [-0.5, 0.5], [0.25, 0.5], [1, 0], [1, 0]]);
  });

  test("says what is shown otherwise than the file has it", async () => {
    const notesOf = async (line: string, row: string): Promise<readonly string[]> => (await open(`1\n${line}\n${row}\n`)).description.notes;
    const box = 'Lattice="2 0 0 0 3 0 0 0 1" Properties=pos:R:3';
    expect(await notesOf(box, "0.5 1 0")).toEqual([]);
    expect(await notesOf(`${box} pbc="T F F"`, "0.5 1 0")).toEqual([]);
    expect(await notesOf(box, "0.5 1 7")).toEqual(["The file is one of space: it is shown from above, without z."]);
    expect(await notesOf("Properties=pos:R:2", "0.5 1")).toEqual(["The file gives no Lattice: the box is the rectangle around the agents."]);
  });

  test("shows the frames before and after one that is damaged", async () => {
    const file = await open(TWO_FRAMES + TWO_FRAMES.replace("0 0 0 3", "0 0 3") + TWO_FRAMES);
    expect(file.description.steps).toEqual([10, 20, NaN, 20, 10, 20]);
    expect((await file.frame(4)).box.height).toBe(3);
    await expect(file.frame(2)).rejects.toThrow("file.xyz, line 10: Lattice is");
  });
});

interface Line {
  readonly line: string;
  readonly row?: string;
  readonly box: readonly [number, number] | null;
  readonly edges: string;
  readonly first: readonly [number, number];
}
const EDGES: Readonly<Record<string, boolean | [boolean, boolean]>> = {
  walls: false, periodic: true, "periodic in x": [true, false], "periodic in y": [false, true],
};
const LINES = JSON.parse(readFileSync(new URL("../../../tests/reference/xyz_lines.json", import.meta.url), "utf8")) as
  { readonly read: readonly Line[]; readonly refused: readonly Line[]; readonly shown: readonly Line[] };
const openLine = ({ line, row }: Line): Promise<XyzFile> => open(`1\n${line}\n${row ?? "X 0.25 0.5 0"}\n`);

describe("The second lines that the program is tested with", () => {
  test.each([...LINES.read, ...LINES.shown])("$line is a box", async (one) => {
    const frame = await (await openLine(one)).frame(0);
    if (one.box === null) return expect(frame.box.periodic).toBe(false);
    expect(frame.box).toEqual({ width: one.box[0], height: one.box[1], periodic: EDGES[one.edges] });
    expect((frame.columns["x"] as Float64Array)[0]).toBeCloseTo(one.first[0], 14);
    expect((frame.columns["y"] as Float64Array)[0]).toBeCloseTo(one.first[1], 14);
  });

  test.each(LINES.refused)("$line is refused with its place", async (one) => {
    await expect(openLine(one)).rejects.toThrow(/file\.xyz, line [23]: /);
  });
});

describe("A damaged XYZ file", () => {
  test.each([
    ["", "file.xyz holds no frame"],
    ["hello\nworld\n", 'file.xyz: line 1 is "hello", not the number of agents of a frame.'],
    ["-3\n\n", 'line 1 is "-3"'],
    ["3\ncomment\nA 1 2\n", "the frame of line 1 is cut off: 1 of its 3 agents are there."],
    ["1\nProperties=pos:R:2\n1 x\n", 'file.xyz, line 3: the y position is "x", but must be a finite number.'],
    ["1\nProperties=pos:R:3\n1 2\n", "file.xyz, line 3: the line has 2 columns, but must have 3."],
    ["1\nProperties=id:I:1\n1\n", "line 3: the file has no positions"],
    ["1\nProperties=pos:R:x\n1 2\n", 'the property "pos" has "x" columns'],
    ['1\nLattice="1 0 0 0" Properties=pos:R:2\n1 2\n', "file.xyz, line 2: Lattice is"],
    ['1\nLattice="2 1 0 0 2 0 0 0 1" Properties=pos:R:2\n1 2\n', "does not lie along x"],
    ["\u0000\u0001\u0002\n", 'line 1 is "???"'],
    ["99999999999\nx\n", "not the number of agents"],
  ])("%j is refused with its line", async (text, message) => {
    await expect(open(text)).rejects.toThrow(message);
  });

  test("whose last frame is cut off shows those before, and says so", async () => {
    const file = await open(TWO_FRAMES.slice(0, -30));
    expect(file.description.steps).toEqual([10]);
    expect(file.description.notes).toEqual(["the frame of line 5 is cut off: 1 of its 2 agents are there. The 1 before are shown."]);
  });
});

describe("XYZ files of Gridlock", () => {
  let place: Workplace;
  beforeAll(() => {
    place = new Workplace();
    place.run(SMALL_RUN, "results");
    place.gridlock("export", "results", "--to", "xyz", "-o", "frames.xyz");
  });
  afterAll(() => place.end());

  test("have every frame of the trajectory, and the last is the final state", async () => {
    const frames = await open(readFileSync(place.of("frames.xyz"), "utf8"));
    const final = await open(readFileSync(place.of("results/final.xyz"), "utf8"));
    expect(frames.description.steps).toEqual([0, 20, 40, 60]);
    const [last, state] = [await frames.frame(3), await final.frame(0)];
    expect([...last.ids].sort((a, b) => a - b)).toEqual([...Array(60).keys()]);
    for (const name of ["x", "y", "radius", "velocity_x"]) expect([...(last.columns[name] as Float64Array)], name).toEqual([...(state.columns[name] as Float64Array)]);
  });
});
