/** The set-ups of tests/golden/hashes.csv and models.csv as a user would write them; see scenes.hpp and models_test.cpp there. */

import { readFileSync } from "node:fs";
import { join } from "node:path";

const root = join(import.meta.dirname, "../../..");

export interface Row {
  readonly scene: string;
  /** Or the model, or "protocol". */
  readonly engine: string;
  readonly start: string;
  readonly end: string;
}

function rowsOf(file: string): Row[] {
  const lines = readFileSync(join(root, "tests/golden", file), "utf8").trim().split("\n").slice(1);
  return lines.map((line) => {
    const [scene = "", engine = "", start = "", end = ""] = line.split(",");
    return { scene, engine, start, end };
  });
}

const SEED = "run.seed = 20\n";
const WALLS = 'box.edge = "wall"\n';
const PERIODIC = 'box.edge = "periodic"\n';
const CHANNEL = 'box.edge_x = "periodic"\nbox.width = 1.4\nbox.height = 0.9\n';

const DISKS: Readonly<Record<string, string>> = {
  paper: WALLS + "disks.count = 841\ndisks.packing_fraction = 0.7\nengine.cells = 10\nrun.time = 0.5",
  triangular: WALLS + 'disks.count = 400\ndisks.packing_fraction = 0.8\ndisks.start = "triangular"\nengine.contact = "approaching"\nrun.time = 1',
  mixture:
    PERIODIC +
    'disks.count = 200\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nvelocities.kind = "maxwell"\nrun.time = 1\n' +
    "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4, mass = 1.96 }]",
  rectangle:
    PERIODIC +
    "box.width = 3.0\nbox.height = 0.7\ndisks.count = 150\ndisks.packing_fraction = 0.6\n" +
    'disks.start = "triangular"\nengine.time_step = 0.3\nengine.substeps = 2\nrun.time = 1',
  gas: WALLS + "disks.count = 100\ndisks.packing_fraction = 0.02\nrun.time = 10",
  few: PERIODIC + "disks.count = 4\ndisks.packing_fraction = 0.4\nrun.time = 20",
  crowd: WALLS + 'disks.count = 10_000\ndisks.packing_fraction = 0.65\ndisks.start = "triangular"\nrun.time = 0.05',
  large_and_small:
    PERIODIC +
    'disks.count = 4_000\ndisks.packing_fraction = 0.3\ndisks.start = "random"\nrun.time = 0.05\n' +
    "disks.species = [{ fraction = 0.9 }, { fraction = 0.1, size_ratio = 4.0, mass = 16.0 }]",
  channel:
    CHANNEL +
    'disks.count = 200\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nvelocities.kind = "maxwell"\nrun.time = 1\n' +
    "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4, mass = 1.96 }]",
  channel_crowd: CHANNEL + 'disks.count = 10_000\ndisks.packing_fraction = 0.6\ndisks.start = "triangular"\nrun.time = 0.05',
  partition:
    CHANNEL +
    'disks.count = 400\ndisks.packing_fraction = 0.4\ndisks.start = "triangular"\ndisks.region = [0.1, 0, 0.7, 0.9]\nrun.time = 1\n' +
    "walls = [{ from = [0.7, 0], to = [0.7, 0.4] }, { from = [0.7, 0.5], to = [0.7, 0.9] },\n" +
    "{ from = [0, 0.3], to = [0.1, 0.6] }, { from = [1, 0.2], to = [1.2, 0.2] }]",
  upright_channel:
    PERIODIC +
    'box.edge_x = "wall"\nbox.width = 0.9\nbox.height = 1.4\n' +
    'disks.count = 6_000\ndisks.packing_fraction = 0.5\ndisks.start = "triangular"\nrun.time = 0.05',
  brownian:
    PERIODIC +
    'box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nrun.time = 0.5\n' +
    "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4, mass = 1.96 }]\n" +
    'thermostat = { kind = "brownian", temperature = 0.5, interval = 0.004 }',
  brownian_crowd:
    PERIODIC +
    'disks.count = 10_000\ndisks.packing_fraction = 0.5\ndisks.start = "triangular"\nrun.time = 0.05\n' +
    'thermostat = { kind = "brownian", temperature = 0.5, interval = 0.004 }',
  andersen:
    WALLS +
    'box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.5\ndisks.start = "random"\nrun.time = 0.5\n' +
    'thermostat = { kind = "andersen", temperature = 0.5, rate = 20 }',
  obstacles:
    PERIODIC +
    'box.width = 1.3\nbox.height = 0.8\ndisks.count = 300\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nrun.time = 0.5\n' +
    "disks.species = [{ fraction = 0.25, size_ratio = 1.5, fixed = true }, { fraction = 0.75 }]",
  inelastic:
    PERIODIC +
    'box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.5\ndisks.start = "random"\nrun.time = 0.5\ncollisions.restitution = 0.9',
  falling:
    WALLS +
    'box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nrun.time = 0.5\n' +
    "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4, mass = 1.96 }]\ngravity = { x = 0.3, y = -2 }",
  grains:
    WALLS +
    "disks.count = 100\ndisks.packing_fraction = 0.2\ndisks.species = [{ fraction = 0.1, fixed = true }, { fraction = 0.9 }]\n" +
    "collisions = { restitution = 0.8, wall_restitution = 0.9, contact_time = 1e-3 }\ngravity.y = -1\nrun.time = 1\n" +
    "walls = [{ from = [0.1, 0.3], to = [0.5, 0.3] }, { from = [0.8, 0.2], to = [0.8, 0.7] }]",
  brownian_active:
    PERIODIC +
    'box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nrun.time = 0.5\n' +
    'thermostat = { kind = "brownian", temperature = 0.5, interval = 0.004 }\n' +
    "propulsion = { speed = 1.5, rotational_diffusion = 5 }",
  oblique:
    PERIODIC +
    'box.width = 1.2\nbox.height = 1\nbox.tilt = 0.35\ndisks.count = 300\ndisks.packing_fraction = 0.4\ndisks.start = "random"\nrun.time = 0.5\n' +
    "disks.species = [{ fraction = 0.1, fixed = true }, { fraction = 0.5 }, { fraction = 0.4, size_ratio = 1.4 }]",
  oblique_crowd:
    PERIODIC +
    'box.width = 1\nbox.height = 1.3\nbox.tilt = -0.25\ndisks.count = 10_000\ndisks.packing_fraction = 0.6\ndisks.start = "square"\nrun.time = 0.05',
  active:
    PERIODIC +
    'box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.5\ndisks.start = "random"\nrun.time = 2\n' +
    "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4, mass = 1.96 }]\n" +
    "propulsion = { speed = 0.5, rotational_diffusion = 2 }",
  active_crowd:
    WALLS +
    'disks.count = 10_000\ndisks.packing_fraction = 0.6\ndisks.start = "triangular"\nrun.time = 0.1\n' +
    "propulsion = { speed = 0.5, rotational_diffusion = 2 }",
  chains: chains("straight", 'disks.count = 400\ndisks.packing_fraction = 0.7\ndisks.start = "triangular"'),
  chains_newtonian: chains("newtonian", 'disks.count = 400\ndisks.packing_fraction = 0.7\ndisks.start = "triangular"'),
  chains_of_two_sizes: chains(
    "newtonian",
    'disks.count = 200\ndisks.packing_fraction = 0.4\ndisks.start = "random"\n' +
      "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4 }]",
  ),
};

function chains(kind: string, disks: string): string {
  return (
    `${PERIODIC}box.width = 1.2\nbox.height = 0.8\n${disks}\nvelocities.kind = "maxwell"\n` +
    `engine.chains = "${kind}"\nengine.chain_length = 50\nrun.time = 1`
  );
}

const SOFT = PERIODIC + "box.width = 1.2\ndisks.count = 300\ndisks.packing_fraction = 0.6\nengine.speed = 1\nrun.time = 0.1\n";
const SOFT_MIXTURE = SOFT + 'disks.start = "random"\ndisks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4, mass = 1.96 }]\n';
const SOFT_EQUAL = SOFT + 'disks.start = "triangular"\n';
const bath = (kind: string, friction: number): string => `thermostat = { kind = "${kind}", temperature = 0.5, friction = ${friction} }\n`;

const SOFT_DISKS: Readonly<Record<string, string>> = {
  soft_harmonic: SOFT_MIXTURE + "engine.time_step = 0.02",
  soft_hertzian: SOFT_EQUAL + 'engine.time_step = 0.02\npotential.kind = "hertzian"',
  soft_power: SOFT_MIXTURE + 'engine.time_step = 0.002\npotential.kind = "inverse_power"',
  soft_liquid: SOFT_EQUAL + 'engine.time_step = 0.004\npotential.kind = "lennard_jones"',
  soft_langevin: SOFT_MIXTURE + bath("langevin", 5) + 'engine.time_step = 0.004\npotential.kind = "wca"',
  soft_overdamped: SOFT_MIXTURE + bath("overdamped", 100) + 'engine.time_step = 0.001\npotential.kind = "wca"',
  soft_active:
    SOFT_EQUAL + bath("overdamped", 100) + 'engine.time_step = 0.001\npotential.kind = "wca"\n' + "propulsion = { speed = 1, rotational_diffusion = 5 }",
  soft_flow: SOFT_MIXTURE + bath("langevin", 5) + 'engine.time_step = 0.004\npotential.kind = "wca"\nflow.shear_rate = 10',
  soft_table:
    SOFT_MIXTURE +
    'engine.time_step = 0.004\npotential.kind = "table"\n' +
    "potential.distances = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.5]\n" +
    "potential.energies = [60, 40, 24, 12, 5, 1, -0.5, -0.8, -0.4, 0]",
  soft_drag: SOFT_MIXTURE + 'engine.time_step = 0.02\nflow.shear_rate = 10\npair_drag = { coefficient = 5, direction = "normal" }',
};

const MODELS: Readonly<Record<string, string>> = {
  vicsek: PERIODIC + "box.width = 12\nbox.height = 9\nflocking.count = 600\nrun.steps = 100",
  boids: PERIODIC + 'box.side = 100\nflocking.count = 300\nflocking.rule = "boids"\nflocking.radius = 5\nflocking.speed = 1\nrun.steps = 100',
  walls: WALLS + epidemic(),
  periodic: PERIODIC + epidemic(),
  every_event:
    PERIODIC +
    "catalyst.adsorption_rate = 3000\ncatalyst.adsorption_rate_b = 2000\ncatalyst.desorption_rate = 0.5\ncatalyst.hop_rate = 20\n" +
    'catalyst.hop = 0.05\ncatalyst.reaction = "a_with_b"\ncatalyst.reaction_probability = 0.5\ncatalyst.step_length = 0.1\nrun.steps = 20',
  meadow: WALLS + "run.steps = 60",
  endless_meadow: PERIODIC + "box.width = 2\nbox.height = 1\npredation = { side = 30, sheep = 200, regrowth = 10 }\nrun.steps = 60",
  city: WALLS + "box.width = 2\nbox.height = 1.5\nsegregation = { count = 900, radius = 2, wanted = 9 }\nrun.steps = 10",
};

function epidemic(): string {
  return "epidemic.count = 900\nepidemic.infected_at_start = 0.1\nepidemic.radius = 0.05\nepidemic.speed = 0.3\nepidemic.turnover_rate = 0.5\nrun.steps = 100";
}

export interface GoldenRow extends Row {
  readonly toml: string;
}

const found = (toml: string | undefined, row: Row): string => {
  if (toml === undefined) throw new Error(`no set-up for the row ${row.scene} ${row.engine}`);
  return toml;
};

/** Every row of both tables that has a shipped model, with its set-up. */
export function goldenRows(): GoldenRow[] {
  const disks = rowsOf("hashes.csv").map((row) =>
    row.engine === "protocol"
      ? { ...row, toml: readFileSync(join(root, "scenes", `${row.scene}.toml`), "utf8") }
      : { ...row, toml: `${SEED}engine.kind = "${row.engine}"\n${found(DISKS[row.scene] ?? SOFT_DISKS[row.scene], row)}` },
  );
  const shipped = rowsOf("models.csv").filter((row) => row.engine !== "colloid_tiled");
  const models = shipped.map((row) => ({
    ...row,
    toml: `${SEED}model.kind = "${row.engine}"\n${found(MODELS[row.scene], row)}`,
  }));
  return [...disks, ...models];
}
