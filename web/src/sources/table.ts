import type { QuantityTable } from "./source.ts";

/** A table with a header and commas, as Gridlock writes them: numbers, and empty cells where a value is missing. */
export function readTable(text: string): { names: string[]; columns: number[][] } {
  const lines = text.split("\n").filter((line) => line !== "");
  const names = (lines.shift() ?? "").split(",");
  const columns = names.map(() => new Array<number>(lines.length));
  lines.forEach((line, row) => {
    const cells = line.split(",");
    columns.forEach((column, at) => {
      const cell = cells[at] ?? "";
      column[row] = cell === "" ? NaN : Number(cell);
    });
  });
  return { names, columns };
}

/** series.csv as quantities against time; the units are those of the observables of the trajectory. */
export function readSeries(text: string, units: ReadonlyMap<string, string>): QuantityTable {
  const { names, columns } = readTable(text);
  const times = columns[names.indexOf("time")] ?? [];
  const quantities = names.flatMap((name, at) =>
    name === "step" || name === "time" ? [] : [{ name, unit: units.get(name) ?? "", values: columns[at] as number[] }]);
  return { times, quantities };
}
