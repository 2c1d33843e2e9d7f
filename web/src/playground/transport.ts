import { element, grouped, iconButton, icon } from "../page/dom.ts";
import { shortNumber } from "../drawing/overlay.ts";
import type { EngineFrame } from "../engine/engine_client.ts";

/** What is shown of a moment of a run. */
export type Moment = Pick<EngineFrame, "step" | "time" | "count" | "isRunning" | "isFinished" | "stepsPerSecond" | "stateHash">;

/** What the keys of a run do. */
export interface TransportTarget {
  toggle(): void;
  step(): void;
  /** Absent where nothing is kept to go back to; then there is no line of time either. */
  rewind?(): void;
  restart(): void;
  goTo?(step: number): void;
  setSpeed(stepsPerSecond: number | undefined): void;
  copyHash(): void;
}

const SPEEDS: readonly number[] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000];
export const USUAL_SPEED = 50;

/** Run, pause, step, rewind, restart; the speed; the line of time; step, time and hash of the state. */
export class Transport {
  readonly element: HTMLElement;
  private readonly toggle: HTMLButtonElement;
  private readonly rewind: HTMLButtonElement;
  private readonly step: HTMLButtonElement;
  private readonly timeline = element("input", { type: "range", min: 0, max: 1, value: 0, "aria-label": "Step of the run" });
  private readonly pace = element("input", {
    type: "range",
    min: 0,
    max: SPEEDS.length,
    step: 1,
    "aria-label": "Steps a second",
  });
  private readonly paceText = element("output", {});
  private readonly status = element("div", { class: "status" });
  private readonly texts = {
    step: element("b", {}),
    time: element("b", {}),
    count: element("b", {}),
    pace: element("b", {}),
    hash: element("code", {}),
  };
  private furthest = 0;
  private isRunning = false;

  /** `tools` are shown at the end of the line of the status. */
  constructor(
    private readonly target: TransportTarget,
    tools: HTMLElement,
  ) {
    this.toggle = iconButton("run", "Run", () => target.toggle(), "Run (space)");
    this.toggle.classList.add("primary");
    this.rewind = iconButton("rewind", "Rewind", () => target.rewind?.(), "Rewind by a second of watching (,)");
    this.step = iconButton("step", "Single step", () => target.step(), "Single step (.)");
    const restart = iconButton("restart", "Restart", () => target.restart(), "Restart (r)");
    this.timeline.addEventListener("change", () => target.goTo?.(Number(this.timeline.value)));
    this.pace.addEventListener("input", () => {
      this.showSpeed();
      target.setSpeed(this.stepsPerSecond);
    });
    const speed = element("label", { class: "pace" }, element("span", {}, "Rate"), this.pace, this.paceText);
    const keys = element(
      "div",
      { class: "keys", role: "group", "aria-label": "Run" },
      restart,
      this.rewind,
      this.toggle,
      this.step,
      speed,
    );
    this.timeline.hidden = target.goTo === undefined;
    this.rewind.hidden = target.rewind === undefined;
    this.element = element("div", { class: "transport" }, this.timeline, this.statusLine(tools), keys);
    this.stepsPerSecond = USUAL_SPEED;
  }

  /** undefined: as fast as it can. */
  get stepsPerSecond(): number | undefined {
    return SPEEDS[Number(this.pace.value)];
  }

  set stepsPerSecond(value: number | undefined) {
    const at = value === undefined ? SPEEDS.length : SPEEDS.findIndex((speed) => speed >= value);
    this.pace.value = String(at < 0 ? SPEEDS.length : at);
    this.showSpeed();
  }

  /** Begins anew: nothing has been seen of the run. */
  begin(): void {
    this.furthest = 0;
  }

  show(frame: Moment, agentsName: string): void {
    this.furthest = Math.max(this.furthest, frame.step);
    if (document.activeElement !== this.timeline || !this.timeline.matches(":active")) {
      this.timeline.max = String(Math.max(1, this.furthest));
      this.timeline.value = String(frame.step);
    }
    this.timeline.setAttribute("aria-valuetext", `step ${frame.step}`);
    this.texts.step.textContent = grouped(frame.step);
    this.texts.time.textContent = shortNumber(Number(frame.time.toPrecision(5)));
    this.texts.count.textContent = `${grouped(frame.count)} ${agentsName}`;
    this.texts.pace.textContent =
      frame.isRunning
        ? frame.stepsPerSecond > 0
          ? `${grouped(frame.stepsPerSecond)} steps/s`
          : "running"
        : frame.isFinished
          ? "finished"
          : "paused";
    if (frame.stateHash !== "") this.texts.hash.textContent = frame.stateHash;
    else if (frame.isRunning) this.texts.hash.textContent = "…";
    this.rewind.disabled = frame.step === 0;
    this.showToggle(frame);
  }

  private showToggle(frame: Moment): void {
    if (frame.isRunning === this.isRunning && this.toggle.dataset["shown"] === String(frame.isFinished)) return;
    this.isRunning = frame.isRunning;
    this.toggle.dataset["shown"] = String(frame.isFinished);
    const label = frame.isRunning ? "Pause" : frame.isFinished ? "Continue beyond the end" : "Run";
    this.toggle.replaceChildren(icon(frame.isRunning ? "pause" : "run"));
    this.toggle.setAttribute("aria-label", label);
    this.toggle.title = `${label} (space)`;
  }

  private showSpeed(): void {
    const speed = this.stepsPerSecond;
    const text = speed === undefined ? "unlimited" : speed === 1 ? "1 step/s" : `${grouped(speed)} steps/s`;
    this.paceText.textContent = text;
    this.pace.setAttribute("aria-valuetext", text);
  }

  private statusLine(tools: HTMLElement): HTMLElement {
    const part = (name: string, value: HTMLElement): HTMLElement => element("span", {}, `${name} `, value);
    const hash = element(
      "button",
      {
        type: "button",
        class: "hash",
        title: "The hash of every bit of the state, the same as on the command line; click to copy",
        onclick: () => this.target.copyHash(),
      },
      "state hash",
      this.texts.hash,
    );
    this.status.append(
      part("step", this.texts.step),
      part("time", this.texts.time),
      element("span", {}, this.texts.count),
      element("span", {}, this.texts.pace),
      hash,
      tools,
    );
    return this.status;
  }
}
