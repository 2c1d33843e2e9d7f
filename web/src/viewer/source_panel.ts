import { element, setOptions } from "../page/dom.ts";
import type { ServedContents } from "../sources/served.ts";
import type { FrameSource } from "../sources/source.ts";

const MANY_RUNS = 20;

const STATUSES: Readonly<Record<string, string>> = {
  finished: "finished", unfinished: "being written", abandoned: "interrupted: no program of this machine is at work on it; gridlock resume continues it", interrupted: "interrupted: gridlock resume continues it", failed: "failed: these are its frames until then",
  damaged: "its summary.json is damaged",
};

/** What is shown: the run of a sweep by choice, a file of the user's, and what is wrong. */
export class SourcePanel {
  readonly element = element("div", { class: "group" });
  private readonly name = element("p", {}, "No run is open.");
  private readonly status = element("p", { class: "hint" });
  private readonly problem = element("div", { class: "problem", role: "alert", hidden: true });
  private readonly note = element("div", { class: "note", hidden: true });
  private readonly runs = element("select", { "aria-label": "Run of the sweep" });
  private readonly filter = element("input", { type: "text", placeholder: "Part of a name", "aria-label": "Show runs with this in their names", hidden: true });
  private readonly runsField = element("div", { hidden: true }, this.filter, this.runs);
  private readonly back = element("button", { type: "button", class: "button", hidden: true }, "Back to the run");
  private all: readonly string[] = [];
  /** How runs are called, where anything better is known than their directories. */
  names: ReadonlyMap<string, string> = new Map();

  constructor(chooseRun: (id: string) => void, openFiles: (files: readonly File[]) => void, goBack: () => void) {
    this.runs.addEventListener("change", () => chooseRun(this.runs.value));
    this.filter.addEventListener("input", () => this.showRuns(this.runs.value));
    const file = element("input", { type: "file", accept: ".h5,.h5md,.hdf5,.xyz,.extxyz,.exyz", hidden: true });
    file.addEventListener("change", () => {
      openFiles([...(file.files ?? [])]);
      file.value = "";
    });
    const open = element("button", { type: "button", class: "button", onclick: () => file.click() }, "Open a file…");
    this.back.addEventListener("click", goBack);
    const hint = element("p", { class: "hint" }, "Or drop it anywhere on the page: a trajectory in H5MD (.h5), or extended XYZ. It stays on this device.");
    this.element.append(element("h2", {}, "Run"), this.name, this.status, this.runsField, this.problem, this.note, element("div", { class: "buttons" }, open, this.back, file), hint);
  }

  /** The runs of a sweep; of anything else there is nothing to choose. */
  showContents(contents: ServedContents, chosen: string): void {
    this.all = contents.runs;
    this.runsField.hidden = contents.kind !== "sweep";
    this.filter.hidden = contents.runs.length <= MANY_RUNS;
    this.showRuns(chosen);
  }

  /** `canGoBack` where it is a file of the user's in place of a run that is served. */
  showSource(source: FrameSource, canGoBack: boolean): void {
    this.back.hidden = !canGoBack;
    this.name.textContent = this.nameOf(source.name);
    this.status.textContent = STATUSES[source.status] ?? "";
    const { notes } = source.description;
    this.note.hidden = notes.length === 0;
    this.note.textContent = notes.join("\n");
  }

  showProblem(text: string | null): void {
    this.problem.hidden = text === null;
    this.problem.textContent = text ?? "";
  }

  private nameOf(run: string): string {
    return this.names.get(run) ?? run;
  }

  private showRuns(chosen: string): void {
    const part = this.filter.value.trim();
    const shown = part === "" ? this.all : this.all.filter((name) => name.includes(part) || this.nameOf(name).includes(part));
    const options = shown.map((value) => ({ value, name: this.nameOf(value) }));
    if (!shown.includes(chosen)) options.unshift({ value: "", name: shown.length === 0 ? "no such run" : "Choose a run…" });
    setOptions(this.runs, options, shown.includes(chosen) ? chosen : "");
  }
}
