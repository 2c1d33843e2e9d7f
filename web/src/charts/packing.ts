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

/** The outcome of a protocol: stages.csv, levels.csv, shear.csv and the results of its last stages. */
export interface PackingTables {
  readonly stages: NamedColumns;
  /** Without rows where no disks are soft. */
  readonly levels: NamedColumns;
  /** Minima along a strain; without rows where no stage shears. */
  readonly shear: NamedColumns;
  readonly results: readonly Estimate[];
}

/** A chart with its data: the abscissa, then every curve. */
export interface PackingChart {
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
export function chartsOfLevels(tables: PackingTables): PackingChart[] {
  const numbers = [...new Set(column(tables.levels, "stage"))];
  const last = numbers.at(-1);
  if (last === undefined) return [];
  const { documentation } = LEVELS;
  const abscissa = { name: "packing fraction φ", values: column(tables.levels, "packing_fraction") };
  const of = (title: string, unit: string, quantity: string): PackingChart =>
    chart(tables.levels, abscissa, title, unit, curvesByStage(tables.stages, numbers, quantity, documentation[quantity] ?? ""));
  const moduli = ["bulk_modulus", "shear_modulus"].map((quantity) => ({
    stage: last,
    name: quantity,
    quantity,
    documentation: documentation[quantity] ?? "",
  }));
  return [
    of("Pressure of soft disks", "ε / D²", "pressure"),
    of("Contact number", "", "contact_number"),
    chart(tables.levels, abscissa, `Elastic moduli, stage ${nameOfStage(tables.stages, last)}`, "ε / D²", moduli),
  ];
}

/** Shear stress and pressure of the minima of every stage that shears, against the strain. */
export function chartsOfShear({ stages, shear }: PackingTables): PackingChart[] {
  const numbers = [...new Set(column(shear, "stage"))];
  if (numbers.length === 0) return [];
  const of = (title: string, quantity: string, documentation: string): PackingChart =>
    chart(shear, strainOf(shear), title, "ε / D²", curvesByStage(stages, numbers, quantity, documentation));
  return [
    of("Stress against strain", "shear_stress", "The shear stress of the packing. A straight rise is elastic; where it drops, some disks have slipped past others."),
    of("Pressure under shear", "pressure", "Of the same packings: disks that are sheared in a box of fixed area press more or less on each other."),
  ];
}

/** The strain, or where a stage goes to and fro the length of its path, which only grows. */
function strainOf(shear: NamedColumns): Abscissa {
  const stages = column(shear, "stage");
  const strains = column(shear, "strain");
  const isFirst = (row: number): boolean => stages[row] !== stages[row - 1];
  const step = (row: number): number => (isFirst(row) ? 0 : (strains[row] as number) - (strains[row - 1] as number));
  if (strains.every((_, row) => step(row) >= 0)) return { name: "strain γ", values: strains };
  let path = 0;
  return { name: "path of the strain, Σ |Δγ|", values: strains.map((_, row) => (path = isFirst(row) ? 0 : path + Math.abs(step(row)))) };
}

const LEVELS: { readonly documentation: Readonly<Record<string, string>> } = {
  documentation: {
    pressure: "D is the diameter of the smallest disk. The pressure vanishes where the packing comes apart: at its jamming packing fraction.",
    contact_number: "Contacts of a disk, without rattlers. A packing without friction has about 4 where its pressure vanishes.",
    bulk_modulus: "Against compression.",
    shear_modulus: "Against shear, the mean over all directions.",
  },
};

interface Abscissa {
  readonly name: string;
  readonly values: readonly number[];
}

interface CurveOfStage {
  readonly stage: number;
  readonly name: string;
  readonly quantity: string;
  readonly documentation: string;
}

function curvesByStage(stages: NamedColumns, numbers: readonly number[], quantity: string, documentation: string): CurveOfStage[] {
  return numbers.map((stage) => ({ stage, name: nameOfStage(stages, stage), quantity, documentation }));
}

function chart(table: NamedColumns, abscissa: Abscissa, title: string, unit: string, curves: readonly CurveOfStage[]): PackingChart {
  const stages = column(table, "stage");
  const at = abscissa.values;
  const isShown = (row: number): boolean => curves.some((curve) => curve.stage === stages[row]);
  const rows = [...stages.keys()].filter(isShown).sort((one, other) => (at[one] as number) - (at[other] as number));
  const valueAt = (curve: CurveOfStage, row: number): number =>
    stages[row] === curve.stage ? (column(table, curve.quantity)[row] ?? NaN) : NaN;
  return {
    description: {
      title,
      unit,
      abscissa: abscissa.name,
      curves: curves.map(({ stage, name, documentation }) => ({
        name,
        documentation,
        isOnePoint: stages.filter((one) => one === stage).length === 1,
      })),
    },
    columns: [rows.map((row) => at[row] as number), ...curves.map((curve) => rows.map((row) => valueAt(curve, row)))],
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
