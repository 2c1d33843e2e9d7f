/** Packings in numbers: the stages of their protocol, and the minima that were kept on the way. */

import type { ChartDescription } from "./line_chart.ts";

/** A table by columns of one length; NaN where there is no value. */
export interface NamedColumns {
  /** The names of the rows; empty where they have none. */
  readonly names: readonly string[];
  readonly columns: Readonly<Record<string, readonly number[]>>;
}

/** A mean and its error; NaN for an error that is not known. */
export interface Estimate {
  readonly name: string;
  readonly mean: number;
  readonly standardError: number;
}

/** The outcome of a protocol: stages.csv, levels.csv and the results of its last stages. */
export interface PackingTables {
  readonly stages: NamedColumns;
  /** Without rows where no disks are soft. */
  readonly levels: NamedColumns;
  readonly results: readonly Estimate[];
}

/** A chart with its data: the abscissa, then every curve. */
export interface ChartOfLevels {
  readonly description: ChartDescription;
  readonly columns: readonly (readonly number[])[];
  /** The value of each curve at the end of its stage. */
  readonly ends: readonly number[];
}

/** A stage as it is listed. */
export interface StageRow {
  readonly name: string;
  readonly packingFraction: number;
  readonly pressure: number;
  /** Soft disks have a pressure in ε/D², hard ones Z. */
  readonly isSoft: boolean;
}

const column = (table: NamedColumns, name: string): readonly number[] => table.columns[name] ?? [];

export function stagesOf({ stages, levels }: PackingTables): StageRow[] {
  const soft = new Set(column(levels, "stage"));
  return column(stages, "stage").map((number, row) => ({
    name: `${number} ${stages.names[row] ?? ""}`,
    packingFraction: column(stages, "packing_fraction")[row] ?? NaN,
    pressure: column(stages, "pressure")[row] ?? NaN,
    isSoft: soft.has(number),
  }));
}

/** Pressure and contact number by stage, and the moduli in the last stage of soft disks, all against the packing fraction. */
export function chartsOfLevels(tables: PackingTables): ChartOfLevels[] {
  const numbers = [...new Set(column(tables.levels, "stage"))];
  const last = numbers.at(-1);
  if (last === undefined) return [];
  const byStage = numbers.map((number) => ({ stage: number, name: nameOfStage(tables.stages, number) }));
  const { documentation } = LEVELS;
  const of = (title: string, unit: string, quantity: string): ChartOfLevels =>
    chart(tables.levels, title, unit, byStage.map((one) => ({ ...one, quantity, documentation: documentation[quantity] ?? "" })));
  const moduli = ["bulk_modulus", "shear_modulus"].map((quantity) => ({
    stage: last,
    name: quantity,
    quantity,
    documentation: documentation[quantity] ?? "",
  }));
  return [
    of("Pressure of soft disks", "ε / D²", "pressure"),
    of("Contact number", "", "contact_number"),
    chart(tables.levels, `Elastic moduli, stage ${nameOfStage(tables.stages, last)}`, "ε / D²", moduli),
  ];
}

const LEVELS: { readonly documentation: Readonly<Record<string, string>> } = {
  documentation: {
    pressure: "D is the diameter of the smallest disk. The pressure vanishes where the packing comes apart: at its jamming packing fraction.",
    contact_number: "Contacts of a disk, without rattlers. A packing without friction has about 4 where its pressure vanishes.",
    bulk_modulus: "Against compression.",
    shear_modulus: "Against shear, the mean over all directions.",
  },
};

interface CurveOfLevels {
  readonly stage: number;
  readonly name: string;
  readonly quantity: string;
  readonly documentation: string;
}

function chart(levels: NamedColumns, title: string, unit: string, curves: readonly CurveOfLevels[]): ChartOfLevels {
  const stages = column(levels, "stage");
  const fractions = column(levels, "packing_fraction");
  const isShown = (row: number): boolean => curves.some((curve) => curve.stage === stages[row]);
  const rows = [...stages.keys()].filter(isShown).sort((one, other) => (fractions[one] as number) - (fractions[other] as number));
  const valueAt = (curve: CurveOfLevels, row: number): number =>
    stages[row] === curve.stage ? (column(levels, curve.quantity)[row] ?? NaN) : NaN;
  return {
    description: {
      title,
      unit,
      abscissa: "packing fraction φ",
      curves: curves.map(({ stage, name, documentation }) => ({
        name,
        documentation,
        isOnePoint: stages.filter((one) => one === stage).length === 1,
      })),
    },
    columns: [rows.map((row) => fractions[row] as number), ...curves.map((curve) => rows.map((row) => valueAt(curve, row)))],
    ends: curves.map((curve) => valueAt(curve, stages.lastIndexOf(curve.stage))),
  };
}

function nameOfStage(stages: NamedColumns, number: number): string {
  return `${number} ${stages.names[column(stages, "stage").indexOf(number)] ?? ""}`.trim();
}

/** The area of all disks over that of the box. */
export function packingFraction(radii: ArrayLike<number>, box: { readonly width: number; readonly height: number }): number {
  let sum = 0;
  for (let i = 0; i < radii.length; ++i) sum += (radii[i] as number) ** 2;
  return (Math.PI * sum) / (box.width * box.height);
}

/** A number with the digits that its error leaves, ten at most. */
export function withError(value: number, error: number): string {
  if (!Number.isFinite(value)) return "–";
  if (!(error > 0) || !Number.isFinite(error)) return plain(value, 4);
  const decimals = Math.min(10, Math.max(0, 1 - Math.floor(Math.log10(error))));
  return `${value.toFixed(decimals)} ± ${plain(error, 1)}`;
}

export function plain(value: number, digits: number): string {
  if (!Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits))).replace("e-", "e−").replace(/^-/, "−");
}
