/** Waits; in tests the time may be another. */
export type Sleep = (milliseconds: number) => Promise<void>;

const sleep: Sleep = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/**
 * Which frame is shown, and how it moves on: one after the other at a pace, or the newest of a run that is written.
 *
 * `show` is called for one frame at a time; while it is at work, of further wishes only the last counts.
 */
export class Playback {
  framesPerSecond = 10;
  private at = 0;
  private frames = 0;
  private playing = 0; // which playing is going on, 0 for none: an older one ends by itself
  private begun = 0;
  private wish: number | undefined;
  private showing: Promise<void> | undefined;
  private follows = false;

  constructor(private readonly show: (index: number) => Promise<void>, private readonly onChange: () => void, private readonly wait: Sleep = sleep) {}

  get index(): number {
    return this.at;
  }

  get count(): number {
    return this.frames;
  }

  get isPlaying(): boolean {
    return this.playing !== 0;
  }

  get isFollowing(): boolean {
    return this.follows;
  }

  /** Begins with another source. */
  reset(count: number, follows: boolean): Promise<void> {
    this.pause();
    this.frames = count;
    this.follows = follows;
    return this.goTo(follows ? count - 1 : 0);
  }

  /** There are more frames now, or fewer where the run was begun again. */
  setCount(count: number): Promise<void> {
    this.frames = count;
    if (this.at >= count || (this.follows && !this.isPlaying)) return this.goTo(count - 1);
    this.onChange();
    return Promise.resolve();
  }

  setFollowing(follows: boolean): Promise<void> {
    this.follows = follows;
    if (!follows) {
      this.onChange();
      return Promise.resolve();
    }
    this.pause();
    return this.goTo(this.frames - 1);
  }

  /** The user chooses a frame: who looks back does not follow. */
  choose(index: number): Promise<void> {
    this.pause();
    this.follows = this.follows && index >= this.frames - 1;
    return this.goTo(index);
  }

  toggle(): void {
    if (this.isPlaying) this.pause();
    else void this.play();
  }

  pause(): void {
    if (this.playing === 0) return;
    this.playing = 0;
    this.onChange();
  }

  /** To the last frame, from the first where this is the last one. Resolves when it ends or is paused. */
  async play(): Promise<void> {
    if (this.frames < 2) return;
    this.follows = false;
    const mine = ++this.begun;
    this.playing = mine;
    if (this.at >= this.frames - 1) await this.goTo(0);
    this.onChange();
    let due = performance.now();
    while (this.playing === mine && this.at < this.frames - 1) {
      due += 1000 / this.framesPerSecond;
      await this.wait(Math.max(0, due - performance.now()));
      if (this.playing !== mine) return;
      // Where frames come more slowly than asked for, the pace is theirs.
      due = Math.max(due, performance.now() - 1000);
      await this.goTo(this.at + 1);
    }
    if (this.playing === mine) this.pause();
  }

  private goTo(index: number): Promise<void> {
    this.wish = Math.min(Math.max(0, Math.round(index)), Math.max(0, this.frames - 1));
    this.showing ??= this.showWishes().finally(() => { this.showing = undefined; });
    return this.showing;
  }

  private async showWishes(): Promise<void> {
    while (this.wish !== undefined) {
      this.at = this.wish;
      this.wish = undefined;
      this.onChange();
      if (this.frames > 0) await this.show(this.at);
    }
  }
}
