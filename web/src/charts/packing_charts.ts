import type { Theme } from "../drawing/overlay.ts";
import { element, subscripts } from "../page/dom.ts";
import { LineChart } from "./line_chart.ts";
import { chartsOfLevels, chartsOfShear, plain, stagesOf, withError, type PackingTables } from "./packing.ts";

/** The results that are listed, in this order, where they are known. */
const RESULTS: readonly { name: string; label: string; hint: string; isVerdict?: boolean }[] = [
  { name: "jamming_packing_fraction", label: "Jamming at φ_J", hint: "The packing fraction at which the pressure vanishes; the error is that of the extrapolation." },
  { name: "contact_number", label: "Contact number", hint: "Contacts of a disk, without rattlers." },
  { name: "rattler_share", label: "Share of rattlers", hint: "Disks that nothing holds." },
  { name: "bulk_modulus", label: "Bulk modulus K, ε/D²", hint: "Against compression." },
  { name: "shear_modulus", label: "Shear modulus G, ε/D²", hint: "The mean over all directions." },
  { name: "least_shear_modulus", label: "Softest G, ε/D²", hint: "Against the shear that costs least; below 0 the packing gives way to it." },
  { name: "is_jammed", label: "Jammed", hint: "Forces balance, with pressure and enough contacts and no way down.", isVerdict: true },
  { name: "is_shear_stable", label: "Stable against shear", hint: "The softest G is above 0.", isVerdict: true },
  { name: "shear_strain", label: "Strain γ", hint: "At the end of the last shear." },
  { name: "first_shear_modulus", label: "First slope dσ/dγ, ε/D²", hint: "Of the shear stress against the strain, in the first step." },
  { name: "shear_events", label: "Rearrangements", hint: "Drops of the shear stress, in each of which some disks slip past others." },
  { name: "first_event_strain", label: "First at γ", hint: "The strain of the first rearrangement." },
  { name: "flow_stress", label: "Flow stress, ε/D²", hint: "The mean of the shear stress over the second half of the strain." },
  { name: "reduced_pressure", label: "Z = βP/ρ", hint: "Of the hard disks in the last stage." },
];

/**
 * A packing in numbers: the stages of its protocol, its results, and charts against the packing fraction and the strain.
 *
 * ```ts
 * const packing = new PackingCharts();
 * aside.append(packing.element);
 * packing.setTheme(LIGHT);
 * packing.show(tables);
 * ```
 */
export class PackingCharts {
  readonly element = element("div", { hidden: true });
  private charts: LineChart[] = [];
  private theme: Theme | undefined;

  /** Nothing for a run without a protocol; tables without stages before the first of them has ended. */
  show(tables: PackingTables | undefined): void {
    for (const chart of this.charts) chart.dispose();
    this.charts = [];
    this.element.hidden = tables === undefined;
    if (tables === undefined) return;
    const group = element("div", { class: "group" }, element("h2", {}, "Packing"), ...this.texts(tables));
    this.element.replaceChildren(group);
    for (const { description, columns, ends } of [...chartsOfShear(tables), ...chartsOfLevels(tables)]) {
      const chart = new LineChart(description);
      this.charts.push(chart);
      this.element.append(chart.element);
      if (this.theme !== undefined) chart.setTheme(this.theme);
      chart.setData(columns, ends);
    }
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    for (const chart of this.charts) chart.setTheme(theme);
  }

  private texts(tables: PackingTables): HTMLElement[] {
    const stages = stagesOf(tables);
    if (stages.length === 0) return [element("p", { class: "hint" }, "Stages are listed here as they end.")];
    const units = stages.some((stage) => stage.isSoft) ? [element("p", { class: "hint" }, "Pressure in ε/D², of hard disks Z = βP/ρ.")] : [];
    return [this.stages(tables), ...units, this.results(tables)];
  }

  private stages(tables: PackingTables): HTMLElement {
    const head = ["Stage", "φ", "Pressure"].map((text) => element("th", { scope: "col" }, text));
    const rows = stagesOf(tables).map(({ name, packingFraction, pressure, isSoft }) => {
      const shown = plain(pressure, 3);
      return element(
        "tr",
        {},
        element("th", { scope: "row" }, name),
        element("td", {}, plain(packingFraction, 5)),
        element("td", {}, isSoft || shown === "–" ? shown : `Z = ${shown}`),
      );
    });
    return element("table", { class: "stages" }, element("tr", {}, ...head), ...rows);
  }

  private results({ results }: PackingTables): HTMLElement {
    const known = RESULTS.flatMap((one) => {
      const found = results.find((result) => result.name === one.name);
      return found === undefined ? [] : [{ ...one, ...found }];
    });
    const text = (one: (typeof known)[number]): string =>
      one.isVerdict === true ? (one.mean === 1 ? "yes" : "no") : withError(one.mean, one.standardError);
    return element(
      "dl",
      { class: "values" },
      ...known.flatMap((one) => [element("dt", { title: one.hint }, ...subscripts(one.label)), element("dd", {}, text(one))]),
    );
  }
}
