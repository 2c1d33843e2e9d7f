import { cut, SourceError, type QuantityTable } from "./source.ts";

const NOT_FINITE: Readonly<Record<string, number>> = { "": NaN, nan: NaN, "-nan": NaN, inf: Infinity, "-inf": -Infinity };

/**
 * A table with a header and commas, as Gridlock writes them: numbers, and empty cells where a value is missing. Throws SourceError, which
 * names the line, for what is no such table.
 */
export function readTable(text: string): { names: string[]; columns: number[][] } {
  const [head = "", ...lines] = text.replace(/\n$/, "").split("\n");
  const names = head.split(",");
  if (names.includes("")) throw new SourceError("its first line does not name every column");
  const columns = names.map(() => new Array<number>(lines.length));
  lines.forEach((line, row) => {
    const cells = line.split(",");
    // Below the line with the names, and counted from one.
    const place = `line ${row + 2}`;
    if (cells.length !== names.length) {
      throw new SourceError(`${place} has ${cells.length} ${cells.length === 1 ? "entry" : "entries"} for ${names.length} columns`);
    }
    columns.forEach((column, at) => {
      const cell = cells[at] as string;
      const value = NOT_FINITE[cell] ?? Number(cell);
      if (Number.isNaN(value) && !(cell in NOT_FINITE)) throw new SourceError(`“${cut(cell)}” in ${place}, column ${names[at]}, is not a number`);
      column[row] = value;
    });
  });
  return { names, columns };
}

/** series.csv as quantities against time; throws SourceError where it is damaged. The units are those of the observables of the trajectory. */
export function readSeries(text: string, units: ReadonlyMap<string, string>): QuantityTable {
  const { names, columns } = readTable(text);
  const times = columns[names.indexOf("time")];
  if (times === undefined) throw new SourceError("it has no column time");
  const quantities = names.flatMap((name, at) =>
    name === "step" || name === "time" ? [] : [{ name, unit: units.get(name) ?? "", values: columns[at] as number[] }]);
  return { times, quantities };
}
