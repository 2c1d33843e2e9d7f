/** What is set up: a text of TOML, and what controls have changed since. */

export class Setup {
  private readonly changes = new Map<string, string>();

  /** `given`: settings that belong to a scene beside its text, "engine.cells=10". */
  constructor(
    readonly toml: string,
    readonly sceneName?: string,
    private readonly given: readonly string[] = [],
  ) {}

  /** The same with one setting changed. */
  with(key: string, value: string): Setup {
    const changed = new Setup(this.toml, this.sceneName, this.given);
    for (const [one, text] of this.changes) changed.changes.set(one, text);
    changed.changes.set(key, value);
    return changed;
  }

  get isChanged(): boolean {
    return this.changes.size > 0;
  }

  /** "disks.count=400", as for --set. */
  get overrides(): string[] {
    return [...this.given, ...[...this.changes].map(([key, value]) => `${key}=${value}`)];
  }
}
