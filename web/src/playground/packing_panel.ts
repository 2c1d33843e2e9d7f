import { packingFraction, plain } from "../charts/packing.ts";
import { PackingCharts } from "../charts/packing_charts.ts";
import type { Engine, EngineFrame } from "../engine/engine_client.ts";
import { words } from "../page/dom.ts";

/** The packing that a protocol makes, stage by stage. */
export class PackingPanel extends PackingCharts {
  /** Stages that are shown; undefined before any of this run. */
  private followed: number | undefined;
  private runs = 0; // how many there were, as answers of the engine may come when the next one is open

  begin(): void {
    ++this.runs;
    this.followed = undefined;
    this.show(undefined);
  }

  async follow(engine: Engine, { preparation }: EngineFrame): Promise<void> {
    const { stages, finished } = preparation;
    if (stages === 0 || finished === this.followed) return;
    this.followed = finished;
    const run = this.runs;
    const tables = await engine.packing();
    if (run === this.runs && this.followed === finished) this.show(tables);
  }
}

/** Beside the slider of the packing fraction, which says what the start of a protocol has; empty without a protocol. */
export function densityHint(frame: Pick<EngineFrame, "box" | "radii" | "isPrepared" | "preparation">): string {
  const { stages, finished, what } = frame.preparation;
  if (stages === 0) return "";
  const when = frame.isPrepared ? "after the protocol" : `in stage ${finished + 1} of ${stages}, ${words(what)}`;
  return `Of the start. Now φ = ${plain(packingFraction(frame.radii, frame.box), 5)}, ${when}.`;
}

/** Whether time passes: not before the first step after a protocol. */
export function hasTime({ preparation, step }: EngineFrame): boolean {
  return preparation.stages === 0 || step > 0;
}
