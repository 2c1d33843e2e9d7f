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

  /** As a table with commas; cells without a value are empty. */
  toCsv(): string {
    const lines = [this.names.join(",")];
    for (let row = 0; row < this.length; ++row) {
      lines.push(
        this.columns
          .map((column) => {
            const value = column[row] as number;
            return Number.isNaN(value) ? "" : String(value);
          })
          .join(","),
      );
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
