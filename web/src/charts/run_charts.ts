import type { Theme } from "../drawing/overlay.ts";
import { element, select, words } from "../page/dom.ts";
import { LineChart, type ChartDescription } from "./line_chart.ts";
import type { Series } from "./series.ts";

/** A column that can be drawn against time. */
export interface QuantityColumn {
  readonly name: string;
  readonly unit: string;
  readonly documentation: string;
}

/** Z by the pressure on the walls, which no run writes: that of the virial times the ratio of the pressures. */
const WALL_FACTOR = "wall_compressibility_factor";
const OF_WALL_FACTOR = ["compressibility_factor", "virial_pressure", "wall_pressure"] as const;

/** Quantities that share a chart because a model says so. */
export interface DeclaredChart {
  readonly title: string;
  readonly names: readonly string[];
}

/** What every run may have, in the order of the charts; whatever else there is comes from the model and goes first. */
const GROUPS: readonly { title: string; names: readonly string[] }[] = [
  { title: "Mean displacement", names: ["mean_displacement"] },
  { title: "Compressibility factor Z = PA / NkT", names: ["compressibility_factor", WALL_FACTOR] },
  { title: "Pressure", names: ["virial_pressure", "wall_pressure"] },
  { title: "Sixfold order |ψ6|", names: ["global_bond_orientation_order", "local_bond_orientation_order"] },
  { title: "Share of disks in the largest cluster", names: ["largest_cluster_fraction"] },
  { title: "Variance over mean of the local density", names: ["local_density_variance_ratio"] },
  { title: "Temperature", names: ["temperature_x", "temperature_y"] },
  { title: "Flux through the line", names: ["flux_forward", "flux_backward", "net_flux"] },
];
const SHORT_NAMES: Readonly<Record<string, string>> = {
  compressibility_factor: "collisions",
  [WALL_FACTOR]: "walls",
  virial_pressure: "virial",
  wall_pressure: "walls",
  global_bond_orientation_order: "global",
  local_bond_orientation_order: "local",
  temperature_x: "along x",
  temperature_y: "along y",
  flux_forward: "forward",
  flux_backward: "backward",
  net_flux: "net",
};
/** Columns of every run, in no chart until they are asked for. */
const FURTHER = new Set([
  "agents",
  "step",
  "time",
  "mean_squared_displacement",
  "centre_displacement",
  "kinetic_energy",
  "kinetic_energy_drift",
  "mean_speed",
  "speed_moment_ratio",
  "collision_rate",
  "mean_free_time",
  "halted_fraction",
  "wall_hit_rate",
  "wall_pressure_left",
  "wall_pressure_right",
  "wall_pressure_bottom",
  "wall_pressure_top",
  "velocity_autocorrelation",
  "mean_cluster_size",
  "local_density_mean",
  "diffusion_coefficient",
  "crossings_forward",
  "crossings_backward",
]);
const TEMPERATURE_OF_KIND = /^temperature_[xy]_kind_\d+$/; // as many columns as a mixture has kinds

/**
 * The charts that suit a run: those that are declared, then quantities of a model that say the same of themselves share a chart, as counts
 * of kinds and of events do.
 */
export function chartsFor(measured: readonly QuantityColumn[], declared: readonly DeclaredChart[] = []): ChartDescription[] {
  const isDeclared = (name: string): boolean => declared.some(({ names }) => names.includes(name));
  const first = declared.map(({ title, names }) => {
    const found = names.flatMap((name) => measured.filter((column) => column.name === name));
    return describe(title === names.join() ? titleOf(found) : title, found);
  });
  const columns = withFactors(measured.filter((column) => !isDeclared(column.name)));
  const inGroups = new Set(GROUPS.flatMap((group) => group.names));
  const ofModel = new Map<string, QuantityColumn[]>();
  for (const column of columns) {
    if (inGroups.has(column.name) || FURTHER.has(column.name) || TEMPERATURE_OF_KIND.test(column.name)) continue;
    const key = `${column.documentation} ${column.unit}`;
    ofModel.set(key, [...(ofModel.get(key) ?? []), column]);
  }
  const made = [...ofModel.values()]
    .sort(countsOfEventsLast)
    .flatMap((group) => inSixes(group).map((part) => describe(titleOf(part), part)));
  made.unshift(...first);
  for (const group of GROUPS) {
    const found = columns.filter((column) => group.names.includes(column.name));
    if (found.length > 0) made.push(describe(group.title, found));
  }
  return made;
}

/** Pressures as Z where that is known. */
function withFactors(measured: readonly QuantityColumn[]): readonly QuantityColumn[] {
  const has = (name: string): boolean => measured.some((column) => column.name === name);
  if (!has("compressibility_factor")) return measured;
  const others = measured.filter(({ name }) => name !== "virial_pressure" && name !== "wall_pressure");
  const documentation = "Z = wall pressure · area / (N kT).";
  return OF_WALL_FACTOR.every(has) ? [...others, { name: WALL_FACTOR, unit: "", documentation }] : others;
}

/** The values of a curve of chartsFor(). */
export function valuesOf(series: Series, name: string): readonly number[] {
  if (name !== WALL_FACTOR) return series.column(name);
  const [factor, virial, wall] = OF_WALL_FACTOR.map((one) => series.column(one)) as [readonly number[], readonly number[], readonly number[]];
  return factor.map((value, row) => (value * (wall[row] as number)) / (virial[row] as number));
}

const EVENTS = "Times since the start."; // what every model says of its events

function countsOfEventsLast(one: readonly QuantityColumn[], other: readonly QuantityColumn[]): number {
  return Number(one[0]?.documentation === EVENTS) - Number(other[0]?.documentation === EVENTS);
}

function inSixes(group: readonly QuantityColumn[]): QuantityColumn[][] {
  return Array.from({ length: Math.ceil(group.length / 6) }, (_, i) => group.slice(6 * i, 6 * i + 6));
}

function titleOf(group: readonly QuantityColumn[]): string {
  if (group[0]?.documentation === EVENTS) return "Events since the start";
  const title = group.map((column) => words(column.name)).join(", ");
  return title.charAt(0).toUpperCase() + title.slice(1);
}

function describe(title: string, columns: readonly QuantityColumn[]): ChartDescription {
  return {
    title,
    unit: columns[0]?.unit ?? "",
    abscissa: "time",
    curves: columns.map(({ name, documentation }) => ({ name, documentation })),
  };
}

/**
 * Charts beside a run: those that suit its columns, and one more quantity by choice.
 *
 * ```ts
 * const charts = new RunCharts();
 * aside.append(charts.element);
 * charts.setTheme(LIGHT);
 * charts.begin(columns);
 * series.add(rows);
 * charts.show(series);
 * ```
 */
export class RunCharts {
  readonly element = element("div", {});
  /** A time was clicked in a chart. */
  onChoose: (time: number) => void = () => {};
  private readonly list = element("div", {});
  private readonly further = element("div", {});
  private readonly chooser: HTMLSelectElement;
  private columns: readonly QuantityColumn[] = [];
  private shown: { chart: LineChart; names: readonly string[] }[] = [];
  private extra: { chart: LineChart; names: readonly string[] } | undefined;
  private series: Series | undefined;
  private theme: Theme | undefined;

  constructor() {
    this.chooser = select("Another quantity", [], "", (name) => this.choose(name));
    const field = element("div", { class: "group further" }, this.chooser);
    this.element.append(this.list, this.further, field);
    this.begin([]);
  }

  /** Begins anew with these columns. */
  begin(columns: readonly QuantityColumn[], declared: readonly DeclaredChart[] = []): void {
    for (const { chart } of this.shown) chart.dispose();
    const before = this.chooser.value;
    this.columns = columns;
    this.series = undefined;
    this.shown = chartsFor(columns, declared).map((description) => this.add(description, this.list));
    const options = columns.filter((column) => column.name !== "step" && column.name !== "time");
    this.chooser.replaceChildren(
      element("option", { value: "" }, "Another quantity…"),
      ...options.map((one) => element("option", { value: one.name, title: one.documentation }, words(one.name))),
    );
    this.chooser.value = options.some((one) => one.name === before) ? before : "";
    this.choose(this.chooser.value);
  }

  show(series: Series): void {
    this.series = series;
    for (const one of this.extra === undefined ? this.shown : [...this.shown, this.extra]) {
      one.chart.setData([series.column("time"), ...one.names.map((name) => valuesOf(series, name))]);
    }
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    for (const { chart } of this.shown) chart.setTheme(theme);
    this.extra?.chart.setTheme(theme);
  }

  private choose(name: string): void {
    this.extra?.chart.dispose();
    this.extra = undefined;
    const column = this.columns.find((one) => one.name === name);
    if (column === undefined) return;
    this.extra = this.add(describe(titleOf([column]), [column]), this.further);
    if (this.series !== undefined) this.show(this.series);
  }

  private add(description: ChartDescription, host: HTMLElement): { chart: LineChart; names: readonly string[] } {
    const names = description.curves.map((curve) => curve.name);
    const curves = description.curves.map((curve) => ({ ...curve, name: SHORT_NAMES[curve.name] ?? curve.name }));
    const chart = new LineChart({ ...description, curves });
    chart.onChoose = (time) => this.onChoose(time);
    host.append(chart.element);
    if (this.theme !== undefined) chart.setTheme(this.theme);
    return { chart, names };
  }
}
