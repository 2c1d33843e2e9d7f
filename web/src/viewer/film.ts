import { shortNumber } from "../drawing/overlay.ts";
import { element, grouped, icon, iconButton } from "../page/dom.ts";
import type { SourceFrame } from "../sources/source.ts";
import type { Playback } from "./playback.ts";

const PACES: readonly number[] = [1, 2, 5, 10, 15, 25, 30, 60];
const USUAL_PACE = 10;

/** Play, pause, one frame on or back; the pace; the line of frames; what is shown. */
export class Film {
  readonly element: HTMLElement;
  private readonly play: HTMLButtonElement;
  private readonly slider = element("input", { type: "range", min: 0, max: 0, value: 0, "aria-label": "Frame" });
  private readonly pace = element("input", { type: "range", min: 0, max: PACES.length - 1, step: 1, "aria-label": "Frames a second" });
  private readonly paceText = element("output", {});
  private readonly follow = element("input", { type: "checkbox" });
  private readonly followLabel = element("label", { class: "check", hidden: true }, this.follow, "Follow the run");
  private readonly texts = { frame: element("b", {}), step: element("b", {}), time: element("b", {}), count: element("b", {}), hash: element("code", {}) };
  private readonly hash: HTMLElement;
  private isPlaying = false;

  /** `copyHash` is called for a click on the state hash; `tools` are shown at the end of the line of the status. */
  constructor(private readonly playback: Playback, copyHash: () => void, tools: HTMLElement) {
    this.play = iconButton("run", "Play", () => playback.toggle(), "Play (space)");
    this.play.classList.add("primary");
    const first = iconButton("restart", "First frame", () => void playback.choose(0), "First frame (Home)");
    const back = iconButton("rewind", "One frame back", () => void playback.choose(playback.index - 1), "One frame back (,)");
    const next = iconButton("step", "One frame on", () => void playback.choose(playback.index + 1), "One frame on (.)");
    this.slider.addEventListener("input", () => void playback.choose(Number(this.slider.value)));
    this.pace.addEventListener("input", () => this.setPace());
    this.follow.addEventListener("change", () => void playback.setFollowing(this.follow.checked));
    this.pace.value = String(PACES.indexOf(USUAL_PACE));
    this.setPace();
    this.hash = element("span", { class: "hash" }, "state hash",
      element("button", { type: "button", title: "The hash of every bit of the state; click to copy", onclick: copyHash }, this.texts.hash));
    const pace = element("label", { class: "pace" }, element("span", {}, "Rate"), this.pace, this.paceText);
    const keys = element("div", { class: "keys", role: "group", "aria-label": "Frames" }, first, back, this.play, next, pace);
    this.element = element("div", { class: "transport" }, this.slider, this.statusLine(tools), keys);
  }

  /** Whether there is a run to follow. */
  setGrowing(isGrowing: boolean): void {
    this.followLabel.hidden = !isGrowing;
  }

  /** The playback has changed. */
  update(): void {
    const { index, count, isPlaying, isFollowing } = this.playback;
    this.slider.max = String(Math.max(0, count - 1));
    this.slider.value = String(index);
    this.slider.setAttribute("aria-valuetext", `frame ${index + 1} of ${count}`);
    this.texts.frame.textContent = count === 0 ? "–" : `${grouped(index + 1)} of ${grouped(count)}`;
    this.follow.checked = isFollowing;
    if (isPlaying === this.isPlaying) return;
    this.isPlaying = isPlaying;
    const label = isPlaying ? "Pause" : "Play";
    this.play.replaceChildren(icon(isPlaying ? "pause" : "run"));
    this.play.setAttribute("aria-label", label);
    this.play.title = `${label} (space)`;
  }

  /** A frame is on the screen. */
  show(frame: SourceFrame, agents: string): void {
    this.texts.step.textContent = Number.isFinite(frame.step) ? grouped(frame.step) : "–";
    this.texts.time.textContent = Number.isFinite(frame.time) ? shortNumber(Number(frame.time.toPrecision(5))) : "–";
    this.texts.count.textContent = `${grouped(frame.ids.length)} ${agents}`;
    this.texts.hash.textContent = frame.stateHash;
    this.hash.hidden = frame.stateHash === "";
  }

  private setPace(): void {
    this.playback.framesPerSecond = PACES[Number(this.pace.value)] as number;
    const text = this.playback.framesPerSecond === 1 ? "1 frame/s" : `${this.playback.framesPerSecond} frames/s`;
    this.paceText.textContent = text;
    this.pace.setAttribute("aria-valuetext", text);
  }

  private statusLine(tools: HTMLElement): HTMLElement {
    const part = (name: string, value: HTMLElement): HTMLElement => element("span", {}, `${name} `, value);
    return element("div", { class: "status" }, part("frame", this.texts.frame), part("step", this.texts.step), part("time", this.texts.time),
                   element("span", {}, this.texts.count), this.hash, this.followLabel, tools);
  }
}
