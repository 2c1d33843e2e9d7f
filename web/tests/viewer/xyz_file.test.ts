import { readFileSync } from "node:fs";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { BlobBytes, type Bytes } from "../../src/sources/bytes.ts";
import { readComment, XyzFile } from "../../src/sources/xyz_file.ts";
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

  test("reads entries of the comment with and without quotes", () => {
    expect(Object.fromEntries(readComment('a=1 B="x y" pbc="T F T" name=q'))).toEqual({ a: "1", b: "x y", pbc: "T F T", name: "q" });
  });
});

describe("A damaged XYZ file", () => {
  test.each([
    ["", "file.xyz holds no frame"],
    ["hello\nworld\n", 'file.xyz: line 1 is "hello", not the number of agents of a frame.'],
    ["-3\n\n", 'line 1 is "-3"'],
    ["3\ncomment\nA 1 2\n", "the frame of line 1 is cut off: 1 of its 3 agents are there."],
    ["1\nProperties=pos:R:2\n1 x\n", 'file.xyz: line 3 has "x" for a number.'],
    ["1\nProperties=pos:R:3\n1 2\n", "file.xyz: line 3 has 2 of 3 columns."],
    ["1\nProperties=id:I:1\n1\n", "file.xyz has no positions"],
    ["1\nProperties=pos:R:x\n1 2\n", "are damaged"],
    ['1\nLattice="1 0 0" Properties=pos:R:2\n1 2\n', "the lattice of line 2 is no box"],
    ['1\nLattice="2 1 0 0 2 0 0 0 1" Properties=pos:R:2\n1 2\n', "the box of line 2 is sheared"],
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
