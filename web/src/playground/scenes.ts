/** The set-ups of scenes/, which the bundler puts into the page. */

export interface Scene {
  /** "melting": the name of the file. */
  readonly name: string;
  /** One sentence: the comment at its top. */
  readonly documentation: string;
  readonly toml: string;
  /** What its agents are coloured by at first; undefined for the usual colour of such agents. */
  readonly colour?: string;
  /** Settings beside the text, as for --set, none of which changes a bit of the run. */
  readonly given: readonly string[];
}

const FILES = import.meta.glob<string>("../../../scenes/*.toml", { query: "?raw", import: "default", eager: true });

const COLOURS: Readonly<Record<string, string>> = {
  paper: "neighbourhood",
  melting: "psi6",
  mixture: "plain",
  jamming: "plain",
  shear: "plain",
  shear_stable: "plain",
  flow: "plain",
  soft: "plain",
  soft_liquid: "plain",
};

/** Samples often enough for charts that are watched. */
const LIVE_CHARTS: readonly string[] = ["observe.every=5", "observe.structure_every=1"];
/** The paper's lists, and the k of its figure of neighbourhoods. */
const GIVEN: Readonly<Record<string, readonly string[]>> = { paper: ["engine.grid=linked", "engine.cells=10"] };

/** In the order of the alphabet, the paper's scene first. */
export const SCENES: readonly Scene[] = Object.entries(FILES)
  .map(([path, text]) => toScene(path.replace(/^.*\/|\.toml$/g, ""), text))
  .sort((a, b) => (a.name === "paper" ? -1 : b.name === "paper" ? 1 : a.name.localeCompare(b.name)));

export function findScene(name: string): Scene | undefined {
  return SCENES.find((scene) => scene.name === name);
}

function toScene(name: string, text: string): Scene {
  const colour = COLOURS[name];
  return {
    name,
    documentation: commentAtTop(text),
    toml: withoutSweep(text),
    given: [...LIVE_CHARTS, ...(GIVEN[name] ?? [])],
    ...(colour === undefined ? {} : { colour }),
  };
}

/** The sentences of the comment that a file begins with. */
export function commentAtTop(toml: string): string {
  const lines: string[] = [];
  for (const line of toml.split("\n")) {
    if (!line.startsWith("#")) break;
    lines.push(line.replace(/^#\s*/, ""));
  }
  return lines.join(" ");
}

/** A sweep is many runs; the playground shows the one with the values outside of the table [sweep]. */
export function withoutSweep(toml: string): string {
  const lines = toml.split("\n");
  const begin = lines.findIndex((line) => /^\s*\[\s*sweep\s*\]\s*(#.*)?$/.test(line));
  if (begin < 0) return toml;
  const length = lines.slice(begin + 1).findIndex((line) => /^\s*\[{1,2}\s*[a-z_.]+\s*\]{1,2}\s*(#.*)?$/.test(line));
  lines.splice(begin, length < 0 ? lines.length - begin : length + 1);
  return lines.join("\n").trimEnd() + "\n";
}
