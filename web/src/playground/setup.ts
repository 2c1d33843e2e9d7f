/** What is set up: a text of TOML, and what controls have changed since. */

export class Setup {
  private readonly changes = new Map<string, string>();

  constructor(readonly toml: string, readonly sceneName?: string) {}

  /** The same with one setting changed. */
  with(key: string, value: string): Setup {
    const changed = new Setup(this.toml, this.sceneName);
    for (const [one, text] of this.changes) changed.changes.set(one, text);
    changed.changes.set(key, value);
    return changed;
  }

  get isChanged(): boolean {
    return this.changes.size > 0;
  }

  /** "disks.count=400", as for --set. */
  get overrides(): string[] {
    return [...this.changes].map(([key, value]) => `${key}=${value}`);
  }
}
