/** The shortest text that reads back as the same number, as the program writes it: "1.0", "1e-05", "nan". */
export function numberText(value: number): string {
  if (Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  if (Object.is(value, -0)) return "-0.0";
  const [digits, exponent] = value.toExponential().split("e") as [string, string];
  const isPlain = value === 0 || (Number(exponent) >= -4 && Number(exponent) < 16);
  if (!isPlain) return `${digits}e${exponent[0]}${exponent.slice(1).padStart(2, "0")}`;
  return Number.isInteger(value) ? `${value}.0` : String(value);
}

/** The rows of a series as they come, kept column by column, thinned where there are too many to draw. */
export class Series {
  private readonly columns: number[][];
  private readonly most: number;
  /** Only every so many rows are kept. */
  private stride = 1;
  private seen = 0;

  constructor(
    readonly names: readonly string[],
    most = 20_000,
  ) {
    this.columns = names.map(() => []);
    this.most = most;
  }

  get length(): number {
    return this.columns[0]?.length ?? 0;
  }

  get isThinned(): boolean {
    return this.stride > 1;
  }

  clear(): void {
    for (const column of this.columns) column.length = 0;
    this.stride = 1;
    this.seen = 0;
  }

  /** Rows one after the other. */
  add(rows: ArrayLike<number>): void {
    const width = this.names.length;
    for (let at = 0; at + width <= rows.length; at += width) {
      if (this.seen++ % this.stride !== 0) continue;
      this.columns.forEach((column, i) => column.push(Number(rows[at + i])));
      if (this.length > this.most) this.thin();
    }
  }

  column(name: string): readonly number[] {
    return this.columns[this.names.indexOf(name)] ?? [];
  }

  /** As series.csv, byte for byte: steps are counts, all else are numbers. */
  toCsv(): string {
    const lines = [this.names.join(",")];
    const textOf = (name: string, value: number): string => (name === "step" ? String(value) : numberText(value));
    for (let row = 0; row < this.length; ++row) {
      lines.push(this.columns.map((column, at) => textOf(this.names[at] as string, column[row] as number)).join(","));
    }
    return lines.join("\n") + "\n";
  }

  private thin(): void {
    for (const column of this.columns) {
      for (let i = 0; 2 * i < column.length; ++i) column[i] = column[2 * i] as number;
      column.length = Math.ceil(column.length / 2);
    }
    this.stride *= 2;
  }
}
