import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

import { toCss, OKABE_ITO, type Colour } from "../drawing/palettes.ts";
import { shortNumber, type Theme } from "../drawing/overlay.ts";
import { element, words } from "../page/dom.ts";

/** One curve. */
export interface Curve {
  readonly name: string;
  readonly documentation?: string;
  /** Drawn so large that it is seen below the other curves. */
  readonly isOnePoint?: boolean;
}

export interface ChartDescription {
  readonly title: string;
  /** Of the values; empty for pure numbers. */
  readonly unit: string;
  readonly curves: readonly Curve[];
  /** "time", written below its axis. */
  readonly abscissa: string;
}

const HEIGHT = 164;
const POINT = 4;
const LARGE_POINT = 9;
const FEW_SAMPLES = 30; // which are drawn as points too
/** Blue, vermilion, green, purple, orange, sky: told apart by colour-blind readers, on light and dark ground. */
const CURVE_COLOURS = OKABE_ITO.slice(0, 6);
const DASHES: readonly number[][] = [[], [7, 3], [2, 3], [9, 3, 2, 3], [4, 2], [1, 2]];

function curveColour(i: number, theme: Theme): string {
  const colour = CURVE_COLOURS[i % CURVE_COLOURS.length] as Colour;
  const isDark = theme.background[0] < 0.5;
  return toCss(isDark ? (colour.map((part) => 0.3 + 0.7 * part) as unknown as Colour) : colour);
}

/**
 * Curves against time or another quantity, drawn by uPlot, with a legend of the last values. Curves differ in colour and in dashes.
 *
 * ```ts
 * const chart = new LineChart({ title: "Mean speed", unit: "length / time", abscissa: "time", curves: [{ name: "mean_speed" }] });
 * document.body.append(chart.element);
 * chart.setTheme(LIGHT);
 * chart.setData([times, speeds]);
 * chart.onChoose = (time) => goTo(time);
 * ```
 */
export class LineChart {
  readonly element: HTMLElement;
  /** A value of the abscissa was clicked. */
  onChoose: (abscissa: number) => void = () => {};
  private readonly host = element("div", { class: "plot" });
  private readonly values: HTMLElement[] = [];
  private readonly swatches: HTMLElement[] = [];
  private plot: uPlot | undefined;
  private data: uPlot.AlignedData = [[]];
  private ends: readonly number[] | undefined;
  private theme: Theme | undefined;
  private readonly observer: ResizeObserver;

  constructor(private readonly description: ChartDescription) {
    this.element = element("figure", { class: "chart", "aria-label": description.title }, this.header(), this.host);
    this.observer = new ResizeObserver(() => {
      const width = this.host.clientWidth;
      if (this.plot !== undefined && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: HEIGHT });
    });
    this.observer.observe(this.host);
  }

  /**
   * Arrays of one length: the abscissa in ascending order, then every curve; NaN where a value is missing. The legend has `ends`, else the
   * last values.
   */
  setData(columns: readonly ArrayLike<number>[], ends?: readonly number[]): void {
    this.ends = ends;
    const shown = columns.map((column, i) =>
      i === 0 ? column : Array.from(column, (value) => (Number.isFinite(value) ? value : null)),
    );
    this.data = shown as unknown as uPlot.AlignedData;
    if (this.plot === undefined) this.draw();
    else this.plot.setData(this.data);
    this.showValues(this.usualRow());
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.swatches.forEach((swatch, i) => {
      swatch.style.background = curveColour(i, theme);
    });
    this.draw();
  }

  dispose(): void {
    this.observer.disconnect();
    this.plot?.destroy();
    this.element.remove();
  }

  private header(): HTMLElement {
    const { title, unit, curves } = this.description;
    const keys = curves.map((curve) => {
      const swatch = element("span", { class: "swatch" });
      const value = element("span", { class: "value" });
      this.swatches.push(swatch);
      this.values.push(value);
      const name = curves.length > 1 ? [words(curve.name)] : [];
      return element("span", { class: "key", title: curve.documentation ?? "" }, swatch, ...name, value);
    });
    return element(
      "header",
      {},
      element("h3", {}, title),
      element("span", { class: "unit" }, unit),
      element("div", { class: "keys" }, ...keys),
    );
  }

  private usualRow(): number[] {
    return this.ends === undefined ? lastRow(this.data as unknown as ArrayLike<number | null>[]) : [NaN, ...this.ends];
  }

  private showValues(row: readonly number[]): void {
    const texts = this.description.curves.map((_, i) => {
      const value = row[i + 1];
      return value !== undefined && Number.isFinite(value) ? shortNumber(Number(value.toPrecision(4))) : "–";
    });
    texts.forEach((text, i) => {
      (this.values[i] as HTMLElement).textContent = text;
    });
    const said = this.description.curves.map((curve, i) => `${words(curve.name)} ${texts[i]}`).join(", ");
    this.element.setAttribute("aria-label", `${this.description.title}: ${said}`);
  }

  private draw(): void {
    const width = this.host.clientWidth;
    if (this.theme === undefined || width === 0) return;
    this.plot?.destroy();
    this.plot = new uPlot(this.options(this.theme, width), this.data, this.host);
    this.plot.over.addEventListener("click", () => {
      const at = this.plot?.cursor.idx;
      const abscissa = at === undefined || at === null ? undefined : this.data[0][at];
      if (typeof abscissa === "number") this.onChoose(abscissa);
    });
  }

  private options(theme: Theme, width: number): uPlot.Options {
    const faint = toCss(theme.faint);
    const axis: uPlot.Axis = {
      stroke: faint,
      font: "11px system-ui, sans-serif",
      grid: { stroke: gridColour(theme), width: 1 },
      ticks: { show: false },
      gap: 4,
      values: (_, splits) => splits.map(shortAxis),
    };
    return {
      width,
      height: HEIGHT,
      padding: [6, 14, 0, 0],
      legend: { show: false },
      scales: {
        x: { time: false, range: (_, least, most) => rangeOfTime(least, most) },
        y: { range: (_, least, most) => rangeOfValues(least, most) },
      },
      cursor: { y: false, points: { size: 6 }, drag: { x: false, y: false }, sync: { key: `gridlock ${this.description.abscissa}` } },
      axes: [
        { ...axis, size: 22, space: 60, label: this.description.abscissa, labelSize: 16, labelGap: 0, labelFont: axis.font as string },
        { ...axis, size: 50, space: 28 },
      ],
      series: [
        {},
        ...this.description.curves.map((curve, i) => ({
          stroke: curveColour(i, theme),
          width: 1.5,
          dash: DASHES[i % DASHES.length] as number[],
          points: {
            show: (plot: uPlot) => curve.isOnePoint === true || plot.data[0].length < FEW_SAMPLES,
            size: curve.isOnePoint === true ? LARGE_POINT : POINT,
            fill: curveColour(i, theme),
            width: 0,
          },
          spanGaps: true,
        })),
      ],
      hooks: { setCursor: [(plot) => this.showCursor(plot)] },
    };
  }

  /** The values under the pointer, else the last ones. */
  private showCursor(plot: uPlot): void {
    const at = plot.cursor.idx;
    if (at === undefined || at === null) return this.showValues(this.usualRow());
    this.showValues(this.data.map((column) => Number(column[at] ?? NaN)));
  }
}

/** The last number of each column, and of gaps the one before. */
function lastRow(columns: readonly ArrayLike<number | null>[]): number[] {
  return columns.map((column) => {
    for (let i = column.length - 1; i >= Math.max(0, column.length - 200); --i) {
      const value = column[i];
      if (typeof value === "number" && Number.isFinite(value)) return value;
    }
    return NaN;
  });
}

/** From the first sample to the last; some room where there is one alone. */
function rangeOfTime(least: number | null, most: number | null): [number, number] {
  if (least === null || most === null) return [0, 1];
  return most > least ? [least, most] : [least, least + 1];
}

/** A tenth more than the values on either side, but from 0 where they all but begin there. */
function rangeOfValues(least: number | null, most: number | null): [number, number] {
  if (least === null || most === null) return [0, 1];
  const room = most > least ? 0.1 * (most - least) : Math.abs(most) > 0 ? 0.1 * Math.abs(most) : 1;
  return [least >= 0 && least < 2 * room ? 0 : least - room, most + room];
}

function gridColour(theme: Theme): string {
  const [red, green, blue] = theme.faint.map((part) => Math.round(255 * part));
  return `rgba(${red}, ${green}, ${blue}, 0.2)`;
}

function shortAxis(value: number | null): string {
  if (value === null) return "";
  const size = Math.abs(value);
  if (size >= 1e5 || (size > 0 && size < 1e-3)) return value.toExponential(0).replace("e+", "e").replaceAll("-", "−");
  return shortNumber(value);
}
