/** A figure in another page: the picture of the playground, its keys, and what its address asks for besides. */
export interface Figure {
  /** Keys of the settings that have sliders. */
  readonly settings: readonly string[];
  /** Columns that are drawn against time. */
  readonly columns: readonly string[];
  /** Whether it runs at once. */
  readonly runs: boolean;
}

/** Of "#scene=flocking&vary=flocking.noise,flocking.radius&chart=order&run=1". */
export function readFigure(hash: string): Figure {
  const parts = new URLSearchParams(hash.replace(/^#/, ""));
  const names = (part: string): string[] => (parts.get(part) ?? "").split(",").filter((name) => name !== "");
  return { settings: names("vary"), columns: names("chart"), runs: parts.get("run") === "1" };
}
