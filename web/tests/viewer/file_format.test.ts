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

test("A text without a mark is no known format", () => {
  for (const head of ["12\nLattice=", "ITEM", "", "step,time,id", "# a comment"]) expect(recognizeFormat(bytes(head))).toBeUndefined();
});
