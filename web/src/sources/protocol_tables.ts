import type { Estimate, NamedColumns, PackingTables } from "../charts/packing.ts";
import { readTable } from "./table.ts";

/** The files of a run with a protocol: stages.csv, and where it has them levels.csv, summary.json and shear.csv. Throws what is wrong with them. */
export function packingOf(stages: string, levels: string, summary: string, shear = ""): PackingTables {
  return {
    stages: readNamedTable(stages),
    levels: readNamedTable(levels),
    shear: readNamedTable(shear),
    results: summary === "" ? [] : resultsOf(JSON.parse(summary) as Record<string, unknown>),
  };
}

/** A table of numbers, whose column "name", where it has one, holds texts in quotes without commas; no rows of an empty text. */
function readNamedTable(text: string): NamedColumns {
  if (text === "") return { names: [], columns: {} };
  const lines = text.replace(/\n$/, "").split("\n").map((line) => line.split(","));
  const at = (lines[0] ?? []).indexOf("name");
  const names = at < 0 ? [] : lines.slice(1).map((cells) => (cells[at] ?? "").replaceAll('"', ""));
  const numbers = lines.map((cells) => cells.filter((_, place) => place !== at).join(",")).join("\n");
  const table = readTable(numbers);
  return { names, columns: Object.fromEntries(table.names.map((name, place) => [name, table.columns[place] as number[]])) };
}

/** The entries of summary.json that are {"value": …, "error": …}. */
function resultsOf(summary: Readonly<Record<string, unknown>>): Estimate[] {
  return Object.entries(summary).flatMap(([name, entry]) => {
    const { value, error } = (typeof entry === "object" && entry !== null ? entry : {}) as { value?: unknown; error?: unknown };
    return typeof value === "number" ? [{ name, mean: value, standardError: typeof error === "number" ? error : NaN }] : [];
  });
}
