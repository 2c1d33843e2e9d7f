import { describe, expect, test } from "vitest";

import { Camera } from "../../src/drawing/camera.ts";
import { neighbourhoodColour, paint, rangeOf } from "../../src/drawing/colouring.ts";
import { rangeOfField } from "../../src/drawing/field_layer.ts";
import { markRadius, type Frame } from "../../src/drawing/frame.ts";
import { contactLines, contactWidths, shortNumber, ticks } from "../../src/drawing/overlay.ts";
import { PackedAgents } from "../../src/drawing/packed_agents.ts";
import {
  cividis,
  colourCircle,
  KIND_COLOURS,
  NEIGHBOURHOOD_COLOURS,
  OKABE_ITO,
  toCss,
  viridis,
  type Colour,
} from "../../src/drawing/palettes.ts";
import { agentAt, distance } from "../../src/drawing/picking.ts";
import { toSvg } from "../../src/drawing/svg.ts";
import { LIGHT } from "../../src/drawing/overlay.ts";
import { wallsIn } from "../../src/drawing/walls.ts";

describe("A field", () => {
  test("has a range from 0 or below that covers those before it", () => {
    const range = rangeOfField({ columns: 1, rows: 1, values: Int32Array.from([3]) });
    expect(range).toEqual({ least: 0, most: 3 });
    expect(rangeOfField({ columns: 2, rows: 1, values: BigInt64Array.from([-1n, 2n]) }, range)).toEqual({ least: -1, most: 3 });
  });
});

const frameOf = (positions: number[], radius: number | number[], periodic = false): Frame => ({
  box: { width: 1, height: 1, periodic },
  count: positions.length / 2,
  positions: Float64Array.from(positions),
  radius: typeof radius === "number" ? radius : Float64Array.from(radius),
});

/** Two agents in a box that is four times as wide as it is high, or the other way round. */
const oblong = (isTall: boolean, positions: number[], radius = 0.05): Frame => ({
  ...frameOf(isTall ? positions.map((_, i) => positions[i ^ 1] as number) : positions, radius),
  box: { width: isTall ? 0.5 : 2, height: isTall ? 2 : 0.5, periodic: true },
});

const AROUND = [-1, 0, 1].flatMap((dx) => [-1, 0, 1].map((dy) => [dx, dy] as const)).filter(([dx, dy]) => dx !== 0 || dy !== 0);

describe("colours", () => {
  test("no cell shares its colour with one of the eight around it, between walls and in a periodic box", () => {
    for (const periodic of [false, true]) {
      for (const [columns, rows] of [
        [10, 10],
        [9, 7],
        [3, 3],
        [4, 5],
      ] as const) {
        for (let column = 0; column < columns; ++column) {
          for (let row = 0; row < rows; ++row) {
            const own = neighbourhoodColour(column, row, columns, rows, periodic);
            for (const [dx, dy] of AROUND) {
              const [c, r] = periodic ? [(column + dx + columns) % columns, (row + dy + rows) % rows] : [column + dx, row + dy];
              if (c >= 0 && c < columns && r >= 0 && r < rows)
                expect(neighbourhoodColour(c, r, columns, rows, periodic)).not.toBe(own);
            }
          }
        }
      }
    }
  });

  test("scales get brighter all the way, so that they are read in grey and by colour-blind readers", () => {
    for (const scale of [viridis, cividis]) {
      const luminance = ([red, green, blue]: Colour): number =>
        0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
      for (let i = 1; i <= 64; ++i) expect(luminance(scale(i / 64))).toBeGreaterThan(luminance(scale((i - 1) / 64)));
    }
    expect(toCss(viridis(0))).toBe("#440154");
    expect(toCss(viridis(1))).toBe("#fde725");
    expect(viridis(NaN)).toEqual(viridis(0));
  });

  test("the circle of colours ends where it begins", () => {
    colourCircle(0).forEach((part, i) => expect(part).toBeCloseTo(colourCircle(1)[i] as number, 12));
  });

  test("kinds and neighbourhoods differ for people with deuteranopia, protanopia and tritanopia", () => {
    for (const colours of [KIND_COLOURS.slice(0, 6), NEIGHBOURHOOD_COLOURS.filter((_, i) => [0, 1, 3, 4].includes(i))]) {
      for (const simulation of COLOUR_BLINDNESS) {
        const seen = colours.map((colour) => apply(simulation, colour));
        seen.forEach((one, i) =>
          seen.slice(i + 1).forEach((other, j) => expect(difference(one, other), `${i} and ${i + 1 + j}`).toBeGreaterThan(0.02)),
        );
      }
    }
    expect(OKABE_ITO.length).toBe(8);
  });

  test("a value is coloured by its place between the ends, and one that is missing grey", () => {
    const frame = frameOf([0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.4, 0.4], 0.01);
    const { places, palette } = paint(frame, {
      by: "values",
      label: "v",
      values: Float32Array.from([0, 1, 7, NaN]),
      least: 0,
      most: 2,
    });
    expect([...places]).toEqual([0, 128, 255, 256]);
    expect(palette.length).toBe(257);
  });

  test("the cells of a grid are those of its columns and rows, in wide and in tall boxes", () => {
    const wide = oblong(false, [0.1, 0.4, 1.9, 0.1]);
    expect([...paint(wide, { by: "neighbourhood", columns: 8, rows: 2 }).places]).toEqual([3, 1]);
    const tall = oblong(true, [0.1, 0.4, 1.9, 0.1]);
    expect([...paint(tall, { by: "neighbourhood", columns: 2, rows: 8 }).places]).toEqual([1, 3]);
  });

  test("directions go once around the circle of colours, from −π to π", () => {
    const angles = Float64Array.of(-Math.PI, -Math.PI / 2, 0, Math.PI / 2, 3, 3 * Math.PI, NaN);
    const frame = frameOf(Array.from(angles).flatMap(() => [0.1, 0.1]), 0.01);
    const { places, legend } = paint(frame, { by: "directions", label: "direction", values: angles });
    expect([...places]).toEqual([0, 64, 128, 192, Math.floor((3 / (2 * Math.PI) + 0.5) * 256), 0, 256]);
    expect(legend.kind).toBe("circle");
  });

  test("as many values as agents are needed", () => {
    expect(() => paint(frameOf([0.1, 0.1], 0.01), { by: "kinds", label: "k", values: new Uint32Array(2) })).toThrow(RangeError);
  });

  test("up to six radii get colours of their own", () => {
    const { legend, places } = paint(frameOf([0.1, 0.1, 0.3, 0.3, 0.5, 0.5], [0.02, 0.01, 0.02]), { by: "plain" });
    expect([...places]).toEqual([1, 0, 1]);
    expect(legend).toMatchObject({ kind: "list", entries: [{ name: "R = 0.01" }, { name: "R = 0.02" }] });
  });

  test("the range of a column leaves out what is not finite", () => {
    expect(rangeOf(Float64Array.from([3, NaN, -2, Infinity]))).toEqual({ least: -2, most: 3 });
    expect(rangeOf(new Float64Array(0))).toEqual({ least: 0, most: 1 });
  });
});

describe("places", () => {
  test("the camera's pixels and places are inverse to each other, also after zooming and moving", () => {
    const box = { width: 3, height: 0.7, periodic: true };
    const camera = new Camera();
    camera.fit(box, 800, 600, { x: 8, top: 8, bottom: 50 }, true);
    expect(camera.isFitted).toBe(true);
    camera.zoomAt({ x: 100, y: 300 }, 5, box);
    camera.pan(30, -10, box);
    const place = { x: 1.234, y: 0.321 };
    const back = camera.toBox(camera.toPixels(place));
    expect(back.x).toBeCloseTo(place.x, 12);
    expect(back.y).toBeCloseTo(place.y, 12);
    expect(camera.isFitted).toBe(false);
  });

  test("zooming keeps the place under the pointer, and never shows less than the whole box when zooming out", () => {
    const box = { width: 1, height: 1, periodic: false };
    const camera = new Camera();
    camera.fit(box, 500, 500, { x: 0, top: 0, bottom: 0 }, true);
    const before = camera.toBox({ x: 200, y: 300 });
    camera.zoomAt({ x: 200, y: 300 }, 3, box);
    expect(camera.toBox({ x: 200, y: 300 }).x).toBeCloseTo(before.x, 12);
    camera.zoomAt({ x: 10, y: 10 }, 0.001, box);
    expect(camera.toPixels({ x: 0, y: 0 })).toEqual({ x: 0, y: 500 });
  });

  test("the box lies between the margins, in the middle of the room that they leave", () => {
    for (const box of [{ width: 3, height: 0.7, periodic: true }, { width: 0.7, height: 3, periodic: true }]) {
      const camera = new Camera();
      camera.fit(box, 800, 600, { x: 8, top: 20, bottom: 50 }, true);
      const [least, most] = [camera.toPixels({ x: 0, y: box.height }), camera.toPixels({ x: box.width, y: 0 })];
      expect((least.x + most.x) / 2).toBeCloseTo(400, 9);
      expect((least.y + most.y) / 2).toBeCloseTo(20 + (600 - 70) / 2, 9);
      expect(Math.min(least.x - 8, least.y - 20)).toBeCloseTo(0, 9);
    }
  });

  test("a place moves with the pointer that drags it", () => {
    const box = { width: 3, height: 0.7, periodic: true };
    const camera = new Camera();
    camera.fit(box, 800, 600, { x: 8, top: 8, bottom: 50 }, true);
    camera.zoomAt({ x: 400, y: 270 }, 20, box);
    const place = { x: 1.5, y: 0.35 };
    const before = camera.toPixels(place);
    camera.pan(30, -10, box);
    expect(camera.toPixels(place).x).toBeCloseTo(before.x + 30, 9);
    expect(camera.toPixels(place).y).toBeCloseTo(before.y - 10, 9);
  });

  test("a picture that is zoomed in can be dragged to every edge of a wide or a tall box, and no further", () => {
    for (const isTall of [false, true]) {
      const { box } = oblong(isTall, []);
      const camera = new Camera();
      camera.fit(box, 400, 400, { x: 0, top: 0, bottom: 0 }, true);
      camera.zoomAt({ x: 200, y: 200 }, 8, box);
      const middle = (): [number, number] => {
        const { x, y } = camera.toBox({ x: 200, y: 200 });
        return [x / box.width, y / box.height];
      };
      // An eighth of each side is seen, so that its middle stays a sixteenth away from every edge.
      camera.pan(-1e6, 1e6, box);
      expect(middle()[0]).toBeCloseTo(15 / 16, 9);
      expect(middle()[1]).toBeCloseTo(15 / 16, 9);
      camera.pan(1e6, -1e6, box);
      expect(middle()[0]).toBeCloseTo(1 / 16, 9);
      expect(middle()[1]).toBeCloseTo(1 / 16, 9);
    }
  });

  test("images of disks end at the edges of a periodic box, in pixels from above", () => {
    const packed = new PackedAgents();
    const frame = oblong(false, [1, 0.2, 0.5, 0.1]);
    packed.pack(frame, paint(frame, { by: "plain" }));
    const camera = new Camera();
    camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true);
    expect(packed.clip(camera, 2)).toEqual({ left: 0, top: 300, right: 800, bottom: 500 });
    packed.pack({ ...frame, box: { ...frame.box, periodic: false } }, paint(frame, { by: "plain" }));
    expect(packed.clip(camera, 2)).toBeUndefined();
  });

  test("lines of contacts are as wide as their forces, up to three times the mean", () => {
    const camera = new Camera();
    const frame = oblong(false, [1, 0.2, 0.5, 0.1], 0.06);
    camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true); // 200 pixels per length
    const widths = contactWidths(camera, frame, { rows: [], forces: [0, 1, 2, 17] });
    expect(widths.map((width) => Number(width.toFixed(9)))).toEqual([0.75, 0.75, 0.8, 6]); // 200 · 0.06/6 = 2 for the mean of 5
  });

  test("the shortest way in a wide or a tall box leads across the nearest edge", () => {
    for (const isTall of [false, true]) {
      const turned = (x: number, y: number): { x: number; y: number } => (isTall ? { x: y, y: x } : { x, y });
      const frame = oblong(isTall, [0.02, 0.48, 1, 0.2]);
      expect(distance(frame, turned(0.1, 0.05), turned(0.1, 0.45))).toBeCloseTo(0.1, 12);
      expect(distance(frame, turned(0.1, 0.05), turned(1.9, 0.05))).toBeCloseTo(0.2, 12);
      expect(agentAt(frame, turned(0.02, 0.01), 0)).toBe(0);
      expect(agentAt(frame, turned(1.99, 0.48), 0)).toBe(0);
    }
  });

  test("a contact has one line inside, and across an edge of a wide or a tall box one from each of its agents", () => {
    for (const isTall of [false, true]) {
      const camera = new Camera();
      const lines = (...positions: number[]): number => {
        const frame = oblong(isTall, positions);
        camera.fit(frame.box, 400, 400, { x: 8, top: 8, bottom: 50 }, true);
        return contactLines(camera, frame, 0, 1).length;
      };
      expect(lines(1, 0.2, 1, 0.3)).toBe(1);
      expect(lines(1, 0.02, 1, 0.48)).toBe(2);
      expect(lines(0.02, 0.2, 1.98, 0.2)).toBe(2);
    }
  });

  test("disks cut by the edges of a wide or a tall box have one image each", () => {
    for (const isTall of [false, true]) {
      const packed = new PackedAgents();
      const frame = oblong(isTall, [1, 0.48, 1.98, 0.2]);
      packed.pack(frame, paint(frame, { by: "plain" }));
      const images = Array.from({ length: packed.count }, (_, i) => [0, 1].map((k) => Number(packed.numbers[4 * i + k]?.toFixed(3)))).slice(2);
      const expected = [[1, -0.02], [-0.02, 0.2]];
      expect(images).toEqual(isTall ? expected.map(([x, y]) => [y, x]) : expected);
    }
  });

  test("an agent is found at its place, across the edge of a periodic box too", () => {
    const walls = frameOf([0.02, 0.5, 0.6, 0.6], 0.05);
    const periodic = frameOf([0.02, 0.5, 0.6, 0.6], 0.05, true);
    expect(agentAt(walls, { x: 0.61, y: 0.58 }, 0)).toBe(1);
    expect(agentAt(walls, { x: 0.99, y: 0.5 }, 0)).toBeNull();
    expect(agentAt(periodic, { x: 0.99, y: 0.5 }, 0)).toBe(0);
    expect(distance(periodic, { x: 0.1, y: 0.1 }, { x: 0.9, y: 0.9 })).toBeCloseTo(0.2 * Math.SQRT2, 12);
  });

  test("disks that reach across an edge have images there, in a corner three", () => {
    const packed = new PackedAgents();
    const frame = frameOf([0.01, 0.02, 0.5, 0.99, 0.5, 0.5], 0.05, true);
    packed.pack(frame, paint(frame, { by: "plain" }));
    const centres = Array.from({ length: packed.count }, (_, i) =>
      [...packed.numbers.slice(4 * i, 4 * i + 2)].map((value) => Number(value.toFixed(3))),
    );
    expect(centres).toEqual([
      [0.01, 0.02],
      [0.5, 0.99],
      [0.5, 0.5],
      [1.01, 0.02],
      [0.01, 1.02],
      [1.01, 1.02],
      [0.5, -0.01],
    ]);
  });

  test("across the lower and the upper edge of an oblique box images and shortest ways are shifted", () => {
    const lean = (positions: number[]): Frame => ({ ...frameOf(positions, 0.05), box: { width: 1, height: 1, periodic: true, shift: 0.25 } });
    const packed = new PackedAgents();
    const cut = lean([0.9, 0.02, 0.5, 0.99, 0.23, 0.99, 0.01, 0.5]);
    packed.pack(cut, paint(cut, { by: "plain" }));
    const images = Array.from({ length: packed.count }, (_, i) => [0, 1].map((k) => Number(packed.numbers[4 * i + k]?.toFixed(3)))).slice(4);
    // The images of the third are across the lower edge and the left one.
    expect(images).toEqual([[0.15, 1.02], [0.25, -0.01], [0.98, -0.01], [-0.02, -0.01], [1.01, 0.5]]);
    const frame = lean([0.1, 0.05, 0.4, 0.95]);
    expect(distance(frame, { x: 0.1, y: 0.05 }, { x: 0.4, y: 0.95 })).toBeCloseTo(Math.hypot(0.05, 0.1), 12);
    expect(agentAt(frame, { x: 0.15, y: 0.005 }, 0.01)).toBe(1);
    const camera = new Camera();
    camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true);
    const ends = contactLines(camera, frame, 0, 1).map((line) => line.map((end) => Object.values(camera.toBox(end)).map((value) => Number(value.toFixed(9)))));
    expect(ends).toEqual([[[0.1, 0.05], [0.15, -0.05]], [[0.4, 0.95], [0.35, 1.05]]]);
    const svg = toSvg({ frame: cut, paint: paint(cut, { by: "plain" }), camera, overlay: {}, theme: LIGHT, width: 400, height: 400 });
    expect(svg).toContain('<circle cx="60" cy="-8"');
  });

  test("columns of any numbers are packed, with the radius, or of darts the heading, and the place in the palette", () => {
    const box = { width: 10, height: 10, periodic: false };
    const packed = new PackedAgents();
    const packedRows = (frame: Frame): number[][] => {
      packed.pack(frame, { palette: [], places: Uint16Array.from([7, 8]), legend: { kind: "none" } });
      return Array.from({ length: packed.count }, (_, i) => [...packed.numbers.slice(4 * i, 4 * i + 4)]);
    };
    for (const positions of [Float32Array.of(1, 2, 3, 4), Int8Array.of(1, 2, 3, 4), BigInt64Array.of(1n, 2n, 3n, 4n)]) {
      const frame = { box, count: 2, positions };
      expect(packedRows({ ...frame, radius: 0.5 })).toEqual([[1, 2, 0.5, 7], [3, 4, 0.5, 8]]);
      expect(packed.smallest).toBe(0.5);
      expect(packedRows({ ...frame, radius: Float64Array.of(0, 0.25) })).toEqual([[1, 2, 0, 7], [3, 4, 0.25, 8]]);
      expect(packed.smallest).toBe(0.25);
      expect(packedRows({ ...frame, heading: BigUint64Array.of(2n, 3n) })).toEqual([[1, 2, 2, 7], [3, 4, 3, 8]]);
      expect(packed.mark).toBe(markRadius(box, 2));
      expect(packed.smallest).toBe(packed.mark);
    }
    expect(packedRows({ box, count: 0, positions: new Float64Array(0), radius: 0.5 })).toEqual([]);
    expect(packed.smallest).toBe(0);
  });

  test("marks of agents without a radius neither vanish nor cover one another", () => {
    const box = { width: 1, height: 1, periodic: false };
    expect(markRadius(box, 4)).toBe(0.008);
    expect(markRadius(box, 1e7)).toBe(0.0015);
  });
});

test("ticks are at round numbers between the ends", () => {
  expect(ticks(0, 1).map((tick) => tick.text)).toEqual(["0", "0.2", "0.4", "0.6", "0.8", "1"]);
  expect(ticks(-0.05, 0.051).every((tick) => tick.place >= 0 && tick.place <= 1.000001)).toBe(true);
  expect(shortNumber(-0.1)).toBe("−0.1");
});

test("an SVG file has every disk once, its images across the edges, and text that cannot be taken for tags", () => {
  const frame = frameOf([0.01, 0.5, 0.5, 0.5], 0.05, true);
  const camera = new Camera();
  camera.fit(frame.box, 400, 400, { x: 8, top: 8, bottom: 50 }, true);
  const svg = toSvg({
    frame,
    paint: paint(frame, { by: "kinds", label: "<kind>", values: Uint32Array.from([0, 1]), names: ["A & B", "C"] }),
    camera,
    overlay: { grid: { columns: 4, rows: 4 } },
    theme: LIGHT,
    width: 400,
    height: 400,
  });
  expect(svg.match(/<circle/g)?.length).toBe(3);
  expect(svg).toContain("A &amp; B");
  expect(svg).toContain("&lt;kind&gt;");
  expect(() =>
    toSvg({
      frame: { ...frame, count: 200_001 },
      paint: paint(frame, { by: "plain" }),
      camera,
      overlay: {},
      theme: LIGHT,
      width: 1,
      height: 1,
    }),
  ).toThrow(/PNG/);
});

test("walls inside the box are read from the settings of a run, and from its own line alone", () => {
  const line = "walls = [{ from = [0.0, 18.0], to = [8.4, 1e-05] }, { from = [20.0, 18.5], to = [11.6, 10.0] }]\n";
  const walls = [
    { from: { x: 0, y: 18 }, to: { x: 8.4, y: 1e-5 } },
    { from: { x: 20, y: 18.5 }, to: { x: 11.6, y: 10 } },
  ];
  expect(wallsIn(`${line}\n[box]\nwidth = 20.0\n`)).toEqual(walls);
  expect(wallsIn("walls = []\nprotocol = [{ from = [1.0, 2.0], to = [3.0, 4.0] }]\n")).toEqual([]);
  expect(wallsIn("[box]\nwidth = 20.0\n")).toEqual([]);
  expect(wallsIn("")).toEqual([]);
});

test("an SVG file has the walls inside the box from one end to the other", () => {
  const frame = frameOf([0.5, 0.5], 0.1);
  const camera = new Camera();
  camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true);
  const walls = [{ from: { x: 0, y: 0.75 }, to: { x: 0.5, y: 0.25 } }];
  const svg = toSvg({ frame, paint: paint(frame, { by: "plain" }), camera, overlay: { walls }, theme: LIGHT, width: 400, height: 400 });
  expect(svg).toContain(`<path d="M0 100L200 300" fill="none" stroke="${toCss(LIGHT.ink)}" stroke-width="2"/>`);
});

test("an SVG file of a wide or a tall box has its grid and the images of its disks where they are", () => {
  for (const isTall of [false, true]) {
    const frame = oblong(isTall, [1, 0.48, 1.98, 0.2]);
    const camera = new Camera();
    camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true); // 200 pixels per length, the box in the middle
    const grid = isTall ? { columns: 2, rows: 4 } : { columns: 4, rows: 2 };
    const svg = toSvg({ frame, paint: paint(frame, { by: "plain" }), camera, overlay: { grid }, theme: LIGHT, width: 400, height: 400 });
    const [across, down] = isTall ? ["M200 0v400", "M150 100h100M150 200h100M150 300h100"] : ["M100 150v100M200 150v100M300 150v100", "M0 200h400"];
    expect(svg).toContain(`<path d="${across}${down}"`);
    const centres = [...svg.matchAll(/<circle cx="([-0-9.]+)" cy="([-0-9.]+)"/g)].map((found) => [Number(found[1]), Number(found[2])]);
    const places = [[1, 0.48], [1, -0.02], [1.98, 0.2], [-0.02, 0.2]];
    const expected = places.map(([x, y]) => camera.toPixels(isTall ? { x: y as number, y: x as number } : { x: x as number, y: y as number }));
    const rounded = expected.map(({ x, y }) => [Number(x.toFixed(2)), Number(y.toFixed(2))]);
    expect(centres.sort()).toEqual(rounded.sort());
  }
});

test("an SVG file has darts that point where their agents go", () => {
  const frame: Frame = { box: { width: 2, height: 1, periodic: false }, count: 2, positions: Float64Array.of(0.5, 0.25, 1.5, 0.75), heading: Float64Array.of(Math.PI / 2, -Math.PI / 4) };
  const camera = new Camera();
  camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true);
  const svg = toSvg({ frame, paint: paint(frame, { by: "plain" }), camera, overlay: {}, theme: LIGHT, width: 400, height: 400 });
  // Pixels count downwards, so that a turn to the left is a negative one.
  expect([...svg.matchAll(/transform="([^"]+)"/g)].map((found) => found[1])).toEqual(["translate(100 250) rotate(-90)", "translate(300 150) rotate(45)"]);
});

test("an SVG file has the cells of a search where the agents in them are", () => {
  const frame = { ...oblong(false, [0.6, 0.1, 1, 0.2]) };
  const camera = new Camera();
  camera.fit(frame.box, 400, 400, { x: 0, top: 0, bottom: 0 }, true);
  const block = { columns: 4, rows: 2, cells: [{ column: 1, row: 0 }], agents: [0], near: [] };
  const svg = toSvg({ frame, paint: paint(frame, { by: "plain" }), camera, overlay: { block }, theme: LIGHT, width: 400, height: 400 });
  // The box is 400 × 100 pixels in the middle, from y = 150 to 250: the lower row of cells is 200 to 250.
  expect(svg).toContain('<rect x="100" y="200" width="100" height="50"');
});

function linear(part: number): number {
  return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
}

/** G. M. Machado et al. 2009, doi:10.1109/TVCG.2009.113, severity 1: protanopia, deuteranopia, tritanopia; on linear colours. */
const COLOUR_BLINDNESS = [
  [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
];

function apply(matrix: readonly number[], colour: Colour): number[] {
  const parts = colour.map(linear);
  return [0, 1, 2].map((row) => parts.reduce((sum, part, i) => sum + (matrix[3 * row + i] as number) * part, 0));
}

/** Between two linear colours, in Oklab (B. Ottosson 2020); 0.02 is about what an eye just tells apart. */
function difference(a: readonly number[], b: readonly number[]): number {
  const [one, other] = [a, b].map(oklab) as [number[], number[]];
  return Math.hypot(...one.map((part, i) => part - (other[i] as number)));
}

function oklab([r, g, b]: readonly number[]): number[] {
  const root = (x: number): number => Math.cbrt(Math.max(0, x));
  const [red, green, blue] = [r ?? 0, g ?? 0, b ?? 0];
  const l = root(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue);
  const m = root(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue);
  const s = root(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}
