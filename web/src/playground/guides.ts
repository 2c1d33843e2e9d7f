/** A short lesson for each scene: what to do, what to look at, a question. */

import { element, subscripts } from "../page/dom.ts";

/** Names of controls, charts and quantities on the page stand between asterisks. */
export interface Guide {
  readonly act: string;
  readonly see: string;
  readonly ask: string;
}

export const GUIDES: Readonly<Record<string, Guide>> = {
  paper: {
    act: "Press *Run*. Then drag *Packing fraction φ* to 0.5 and to 0.75. Click a disk.",
    see: "The chart *Mean displacement*: at low φ it keeps growing, at high φ it stops, for every disk is held by its neighbours. A clicked disk looks for contacts in nine cells only.",
    ask: "Above which φ do the disks stay near their places? Why is it enough to look at nine cells?",
  },
  catalyst: {
    act: "Press *Run*. Then set *Adsorption rate b* to 100, so that A arrives five times as often as B.",
    see: "The number of each species, and how often the events have happened.",
    ask: "Which species covers the surface in the end? In the same time, are there five times fewer reactions, or far fewer still? Why?",
  },
  density_sweep: {
    act: "Press *Run*, and drag *Packing fraction φ* slowly from 0.3 to 0.75.",
    see: "The chart *Mean displacement*, in sides of the box: how far a disk has come from where it started.",
    ask: "At which φ does it fall most? Choose the *Start* triangular: is it the same density?",
  },
  epidemic: {
    act: "Set *Turnover rate* to 0 and press *Run*. Then set *Infection rate* to 0.1 and to 0.06.",
    see: "The curves of the susceptible, infected and recovered: one wave. In the picture the disease spreads from a few places.",
    ask: "Why does the wave end although some were never infected? Does a lower rate change how many fall ill, or only when?",
  },
  colloid: {
    act: "Press *Run*. Then set *Thermostat* to none, and run again.",
    see: "The chart *Mean displacement*: disks that lose their velocity after every *Interval* spread as the square root of time, free ones faster.",
    ask: "How long does a disk of diameter 1 need to go as far as itself, with the bath and without? How does that depend on the *Interval*?",
  },
  active: {
    act: "Press *Run* and wait for clusters. Then set *Rotational diffusion D_R* to 1, and to 0.02 again.",
    see: "Disks that swim into each other halt until their headings have turned away: while they wait, others arrive. The chart of *effective swim speed* falls as clusters grow.",
    ask: "Disks do not attract each other. Why do they gather all the same, and why not where *Rotational diffusion D_R* is large?",
  },
  channel: {
    act: "Press *Run*. Look at the order of the disks from left to right, now and after a while.",
    see: "The channel is too narrow for two disks side by side: none passes another. The left and the right edge are one.",
    ask: "The chart *Mean displacement* grows more slowly than in a wide box. Who stands in the way of a disk, and of the one behind it?",
  },
  hopper: {
    act: "Press *Run*. Then set *Restitution e* to 0.5, and *Gravity* to -3.",
    see: "Grains fall on two slanted walls and flow out through the gap between them.",
    ask: "Does the flow stop while grains are left above the gap? What would a narrower gap change?",
  },
  lorentz: {
    act: "Press *Run*. Click a small disk and follow it. Then set *Share of fixed disks* to 0.6.",
    see: "Large disks are fixed. Small ones fly straight from one to the next, and now and then through an empty site to other rows.",
    ask: "A small disk keeps its speed when it hits a large one. Why does it forget its direction all the same, and how fast?",
  },
  epidemic_mixed: {
    act: "Press *Run*. Then set *Speed* to 0.005, so that each meets the same few others again and again.",
    see: "The curve of the infected: how high its peak is, and when it comes.",
    ask: "Equations for an epidemic take it that everybody meets everybody. Which of the two runs do they describe? What do they get wrong in the other?",
  },
  flocking: {
    act: "Press *Run* and move *Rate* to its right end. When the chart *Order* is flat, set *Noise* to 3.",
    see: "Colours are directions. *Order* is 1 where all go one way, and near 0 where directions are random.",
    ask: "Who decides where the flock goes? At which noise does it dissolve?",
  },
  jamming: {
    act: "Press *Run*: the disks are blown up to φ = 0.86, pushed apart until forces balance, and let out until almost no pressure is left.",
    see: "Lines are forces, the thicker the stronger. A disk without a line is held by nobody: a rattler. In the charts the pressure vanishes at φ_J, and the *Contact number* comes near 4.",
    ask: "Each disk can move in two directions, and each contact belongs to two disks. Why are 4 contacts just enough? Does another *Seed* jam at the same φ?",
  },
  melting: {
    act: "Press *Run*. When all has changed colour, set *Packing fraction φ* to 0.75, then look for the density between.",
    see: "Yellow disks have six neighbours at equal angles, as in a crystal. The chart *Sixfold order |ψ6|* says how far the whole box has one direction.",
    ask: "There is no attraction here. Why can disks be a crystal at all? Between which φ does it change, and how does that depend on the *Number of disks N*?",
  },
  mixture: {
    act: "Press *Run*. Set *Packing fraction φ* to 0.1, 0.3 and 0.5.",
    see: "The chart *Compressibility factor Z = PA / NkT*. A gas of points would have Z = 1.",
    ask: "For small φ, Z is about 1 + 2φ. Up to which φ is that right to a tenth? Why is Z above 1?",
  },
  paper_length: {
    act: "Move *Rate* to its right end and press *Run*. Set *Packing fraction φ* to 0.70, 0.73 and 0.76.",
    see: "The chart *Mean displacement*, at 1,000 and at 10,000 steps. Drag the line of time to go back.",
    ask: "For which φ has it come to rest after 10,000 steps? What does that say of a simulation that ends there?",
  },
  shear: {
    act: "Press *Run*: the disks are pushed apart at φ = 0.86, then the box is sheared in 200 small steps, and forces balance after each. Then set *Quench at φ* to 0.9.",
    see: "The chart *Stress against strain*: where it rises the packing answers as a solid, where it drops at once some disks slip past others. Lines are forces, the thicker the stronger.",
    ask: "Which of the two packings is stiffer, and which slips first? Does another *Seed* slip at the same strain?",
  },
  shear_stable: {
    act: "Press *Run*: the disks are pushed apart at φ = 0.86, then their radii shrink until they hardly press. The box may change its shape meanwhile.",
    see: "The box has become oblique, and *Stable against shear* says yes: two contacts more than needed hold every shear. In the scene jamming it says no.",
    ask: "Why are two contacts more needed, not one and not three? In how many ways can the box change its shape without changing its area?",
  },
  flow: {
    act: "Press *Run* and watch a disk near the top and one near the bottom. Then set *Shear rate γ̇* to 0.01, and to 0.",
    see: "Rows slide over each other, the upper ones faster. A disk that leaves at the top comes back below, each time farther along.",
    ask: "Honey flows at any push, mayonnaise needs one that is strong enough. Which of the two are these disks, and how would the stress tell?",
  },
  soft: {
    act: "Move *Rate* to its right end and press *Run*. Then set *Number of disks N* to 400, which is φ = 0.36.",
    see: "The chart *Mean displacement*: where soft disks overlap, their neighbours hold them and the curve flattens; where they have room, it keeps growing.",
    ask: "Hard disks cannot be denser than about 0.91. What do soft disks pay for being denser still?",
  },
  soft_liquid: {
    act: "Move *Rate* to its right end, set *Number of disks N* to 500 and *Temperature kT* to 0.4, and press *Run*. When there are drops, set *Temperature kT* to 1.",
    see: "In a cold bath disks that attract each other gather in drops, which merge where they touch. In a hot bath they spread through the whole box.",
    ask: "With all 1000 disks, are there drops or holes? At which temperature is there no liquid any more?",
  },
  turn_order: {
    act: "Run to the end with the *Engine* stepped, then with tiled. Set *Packing fraction φ* to 0.7 and compare again.",
    see: "The chart *Mean displacement*. Both engines follow one rule; disks only take their turns in another order.",
    ask: "Does the order of turns change the result? Another *Seed* changes it too: how do you tell the two apart?",
  },
  vicsek: {
    act: "Move *Rate* to its right end. Set *Noise* to 0.5, 2, 3 and 4.5, and run each for a while.",
    see: "The chart *Order*: its mean, and by how much it goes up and down.",
    ask: "At which noise does the order go up and down most? Repeat it with another *Seed*: is it the same?",
  },
};

/** The text with its names in bold letters. */
function marked(text: string): (HTMLElement | string)[] {
  return text.split("*").flatMap((part, i) => (i % 2 === 1 ? [element("b", {}, part)] : subscripts(part.replaceAll(" = ", "\u00a0=\u00a0"))));
}

/** The names that a guide uses. */
export function namesIn({ act, see, ask }: Guide): string[] {
  return [act, see, ask].flatMap((text) => text.split("*").filter((_, i) => i % 2 === 1));
}

/** The comment of a scene and its guide; for a set-up of the user's own the comment alone. */
export function guideElements(comment: string, scene: string | undefined): HTMLElement[] {
  const guide = scene === undefined ? undefined : GUIDES[scene];
  const about = element("p", { class: "hint" }, comment);
  if (guide === undefined) return [about];
  const part = (name: string, text: string): HTMLElement => element("p", {}, element("i", {}, name), " ", ...marked(text));
  return [about, part("Do", guide.act), part("Look at", guide.see), part("Ask", guide.ask)];
}
