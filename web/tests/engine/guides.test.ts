import { expect, it } from "vitest";

import { chartsFor } from "../../src/charts/run_charts.ts";
import { loadGridlock } from "../../src/engine/gridlock.ts";
import { words } from "../../src/page/dom.ts";
import { mainKeys, nameOf } from "../../src/playground/controls.ts";
import { GUIDES, namesIn } from "../../src/playground/guides.ts";
import { SCENES } from "../../src/playground/scenes.ts";

/** On the page of every scene. */
const EVERYWHERE = ["Run", "Restart", "Single step", "Rate", "state hash", "Scene", "Colour by"];
const OF_PACKINGS = ["Contact number", "Stable against shear"];
const OF_SHEAR = ["Stress against strain", "Pressure under shear"];

it("every name in a guide is that of a control or a chart on the page of its scene", async () => {
  const gridlock = await loadGridlock();
  for (const scene of SCENES) {
    const session = gridlock.open(scene.toml, scene.given);
    const controls = mainKeys(gridlock.settings(), session.values()).map(nameOf);
    const charts = chartsFor(session.seriesColumns()).flatMap(({ title, curves }) => [title, ...curves.map(({ name }) => words(name))]);
    const packing = session.preparation.stages > 0 ? OF_PACKINGS : [];
    const shear = scene.toml.includes('stage = "shear"') ? OF_SHEAR : [];
    const known = [...EVERYWHERE, ...controls, ...charts, ...packing, ...shear];
    const unknown = namesIn(GUIDES[scene.name] ?? { act: "", see: "", ask: "" }).filter((name) => !known.includes(name));
    expect(unknown, `${scene.name}: ${known.join(", ")}`).toEqual([]);
    session.dispose();
  }
});
