import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { recognizeFormat } from "../../src/sources/file_format.ts";

const bytes = (text: string): Uint8Array => Uint8Array.from(text, (letter) => letter.charCodeAt(0));

test("A file is known by its first bytes, whatever it is called", () => {
  expect(recognizeFormat(bytes("\x89HDF\r\n\x1a\n rest"))?.kind).toBe("h5md");
  for (const [head, name] of [
    ["CDF\x01", "a netCDF file"], ["\xdf\x65\xdf\x65\xdf\x65\xdf\x65", "a GSD file of HOOMD-blue"], ["ITEM: TIMESTEP\n0", "a dump of LAMMPS"],
    ["T\0\0\0CORD", "a DCD trajectory"], ["\x1f\x8b\x08", "a file that gzip packed"],
  ] as const) {
    expect(recognizeFormat(bytes(head))).toEqual({ kind: "other", name });
  }
});

test("Every mark that the program knows is known by the same name", () => {
  const source = readFileSync(new URL("../../../src/io/file_format.cpp", import.meta.url), "utf8");
  const marks = [...source.matchAll(/Mark\{((?:"(?:[^"\\]|\\.)*"\s*)+)sv,\s*(\d+),\s*\{"(\w+)",\s*"([^"]+)"/g)];
  expect(marks.length).toBe(source.split("Mark{").length - 1);
  for (const [, literals, place, id, name] of marks as unknown as [string, string, string, string, string][]) {
    const escaped = [...literals.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((literal) => literal[1]).join("");
    const mark = escaped.replaceAll(/\\x([0-9a-f]{2})|\\r|\\n/g, (escape, code: string | undefined) =>
      code !== undefined ? String.fromCharCode(parseInt(code, 16)) : escape === "\\r" ? "\r" : "\n");
    expect(recognizeFormat(bytes("\0".repeat(Number(place)) + mark)), id).toEqual({ kind: id === "hdf5" ? "h5md" : "other", name });
  }
});

test("A text without a mark is no known format", () => {
  for (const head of ["12\nLattice=", "ITEM", "", "step,time,id", "# a comment"]) expect(recognizeFormat(bytes(head))).toBeUndefined();
});
