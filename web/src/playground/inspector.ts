import type { Block } from "../drawing/overlay.ts";
import type { EngineFrame, Engine, SessionInfo } from "../engine/engine_client.ts";
import type { Neighbourhood } from "../engine/gridlock.ts";
import { element, words } from "../page/dom.ts";

/** The place of an id in ids in ascending order; −1 where it is not there. */
export function rowOf(ids: Float64Array, id: number): number {
  let low = 0;
  let high = ids.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((ids[middle] as number) < id) low = middle + 1;
    else high = middle;
  }
  return ids[low] === id ? low : -1;
}

/** The selected agent: its values, and the cells in which its neighbours are searched. */
export class Inspector {
  readonly element = element("div", { class: "group", hidden: true });
  block: Block | undefined;
  private readonly title = element("h2", {});
  private readonly search = element("p", { class: "hint" });
  private readonly list = element("dl", { class: "values" });
  private selected: number | null = null;
  private isAsking = false;

  constructor(
    private readonly engine: Engine,
    private readonly onBlock: () => void,
  ) {
    this.element.append(this.title, this.search, this.list);
  }

  get id(): number | null {
    return this.selected;
  }

  select(id: number | null): void {
    this.selected = id;
    this.element.hidden = id === null;
    if (id === null) this.block = undefined;
  }

  /** Asks for the agent in the state of now, unless an answer is still to come. */
  async refresh(info: SessionInfo, frame: EngineFrame): Promise<void> {
    const id = this.selected;
    if (id === null || this.isAsking) return;
    if (rowOf(frame.ids, id) < 0) return this.select(null);
    this.isAsking = true;
    try {
      const [values, around] = await Promise.all([this.engine.values(id), this.engine.neighbourhood(id)]);
      if (id === this.selected) this.show(info, frame, values, around);
    } catch {
      this.select(null); // an agent may be gone by the time of the answer
    } finally {
      this.isAsking = false;
    }
    this.onBlock();
  }

  private show(info: SessionInfo, frame: EngineFrame, values: Readonly<Record<string, number>>, around: Neighbourhood): void {
    const { columns, rows } = info.grid;
    const toRows = (ids: readonly number[]): number[] => ids.map((id) => rowOf(frame.ids, id)).filter((row) => row >= 0);
    const cells = around.cells.map((cell) => ({ column: cell % columns, row: Math.floor(cell / columns) }));
    this.block = { columns, rows, cells, agents: toRows(around.ids), near: toRows(around.near) };
    const one = info.agentsName.replace(/s$/, "");
    this.title.textContent = `${one} ${this.selected}`;
    this.search.textContent =
      `The search looks at ${around.ids.length} of ${frame.count - 1} others, in ${around.cells.length} cells of ${columns} × ${rows}. ` +
      `${around.near.length} ${around.near.length === 1 ? "is" : "are"} near.`;
    this.list.replaceChildren(
      ...Object.entries(values).flatMap(([name, value]) => [
        element("dt", {}, words(name)),
        element("dd", {}, wordOf(info, name, value) ?? String(Number(value.toPrecision(8)))),
      ]),
    );
  }
}

function wordOf(info: SessionInfo, column: string, value: number): string | undefined {
  return info.columns.find((one) => one.name === column)?.valueNames[value];
}
