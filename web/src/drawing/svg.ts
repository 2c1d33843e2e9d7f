import type { Camera } from "./camera.ts";
import type { Paint } from "./colouring.ts";
import { imagesInSight, markRadius, numberAt, periodicAxes, positionAt, radiusAt, type Frame, type Point } from "./frame.ts";
import { outlineWidth } from "./packed_agents.ts";
import {
  borders,
  borderWidth,
  boxRectangle,
  CIRCLE_TICKS,
  LEGEND_HEIGHT,
  legendRectangle,
  LIGHT,
  ticks,
  type Block,
  type Overlay,
  type Theme,
  contactLines,
  contactWidths,
} from "./overlay.ts";
import { toCss, UNKNOWN_VALUE } from "./palettes.ts";
import { INNER_WALL_WIDTH } from "./walls.ts";

export interface View {
  readonly frame: Frame;
  readonly paint: Paint;
  readonly camera: Camera;
  readonly overlay: Overlay;
  readonly theme: Theme;
  readonly width: number;
  readonly height: number;
  /** Cells beneath the agents. */
  readonly beneath?: { readonly href: string | undefined };
}

const MOST_AGENTS = 200_000;

const round = (value: number): string => String(Number(value.toFixed(2)));
const escaped = (text: string): string =>
  text.replace(/[&<>"]/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[letter] as string);

/** The view as an SVG file. Throws RangeError for more agents than programs open. */
export function toSvg(view: View): string {
  const { frame, theme, width, height } = view;
  if (frame.count > MOST_AGENTS) {
    throw new RangeError(`an SVG file of ${frame.count} agents is too large for most programs; save a PNG file instead`);
  }
  const box = boxRectangle(view.camera, frame);
  const clip = `<clipPath id="box"><rect x="${round(box.x)}" y="${round(box.y)}" width="${round(box.width)}" height="${round(box.height)}"/></clipPath>`;
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="DejaVu Sans, sans-serif" font-size="12">`,
    `<defs>${clip}</defs>`,
    `<rect width="${width}" height="${height}" fill="${toCss(theme.background)}"/>`,
    ...field(view, box),
    `<g${periodicAxes(frame.box).some(Boolean) ? ' clip-path="url(#box)"' : ""} ${outline(view)}>`,
    ...agents(view),
    "</g>",
    ...lines(view, box),
    ...legend(view),
    "</svg>",
  ].join("\n");
}

function field({ beneath }: View, box: ReturnType<typeof boxRectangle>): string[] {
  if (beneath?.href === undefined) return [];
  const place = `x="${round(box.x)}" y="${round(box.y)}" width="${round(box.width)}" height="${round(box.height)}"`;
  return [`<image ${place} preserveAspectRatio="none" style="image-rendering:pixelated" href="${beneath.href}"/>`];
}

function outline(view: View): string {
  let smallest = Infinity;
  for (let i = 0; i < view.frame.count; ++i) smallest = Math.min(smallest, radiusAt(view.frame, i));
  const thickness = outlineWidth(smallest * view.camera.scale, 1);
  return thickness > 0 && thickness < Infinity ? `stroke="${toCss(LIGHT.ink)}" stroke-width="${round(thickness)}"` : "";
}

function agents(view: View): string[] {
  const { frame, paint, camera } = view;
  const smallest = outlineWidth(radiusAt(frame, 0) * camera.scale, 1);
  const written: string[] = [];
  for (let row = 0; row < frame.count; ++row) {
    const fill = toCss(paint.palette[paint.places[row] as number] ?? UNKNOWN_VALUE);
    for (const centre of images(frame, row)) written.push(agent(view, row, camera.toPixels(centre), fill, smallest));
  }
  return written;
}

/** One agent; its outline lies inside, so that disks in contact touch and do not overlap. */
function agent({ frame, camera }: View, row: number, at: Point, fill: string, outline: number): string {
  const radius = radiusAt(frame, row) * camera.scale;
  if (frame.radius !== undefined || frame.heading === undefined) {
    return `<circle cx="${round(at.x)}" cy="${round(at.y)}" r="${round(Math.max(0.1, radius - outline / 2))}" fill="${fill}"/>`;
  }
  const angle = -(numberAt(frame.heading, row) * 180) / Math.PI;
  const [tip, back, side] = [1.7 * radius, -1.2 * radius, 0.97 * radius].map(round);
  return `<path d="M${tip} 0L${back} ${side}L${back} -${side}Z" fill="${fill}" transform="translate(${round(at.x)} ${round(at.y)}) rotate(${round(angle)})"/>`;
}

function images(frame: Frame, row: number): Point[] {
  const centre = positionAt(frame, row);
  const reach = frame.radius === undefined ? 2.2 * markRadius(frame.box, frame.count) : radiusAt(frame, row);
  return imagesInSight(frame.box, centre.x, centre.y, reach);
}

function lines(view: View, box: ReturnType<typeof boxRectangle>): string[] {
  const { frame, overlay, theme, camera } = view;
  const ink = toCss(theme.ink);
  const written: string[] = [];
  const contacts = overlay.contacts;
  if (contacts !== undefined) {
    const drawn = contactWidths(camera, frame, contacts).flatMap((width, i) =>
      contactLines(camera, frame, Number(contacts.rows[2 * i]), Number(contacts.rows[2 * i + 1])).map(
        ([from, to]) =>
          `<path d="M${round(from.x)} ${round(from.y)}L${round(to.x)} ${round(to.y)}" stroke-width="${round(width)}"/>`,
      ),
    );
    written.push(`<g clip-path="url(#box)" stroke="${ink}" stroke-linecap="round">`, ...drawn, "</g>");
  }
  const grid = overlay.grid;
  if (grid !== undefined) {
    const step = { x: box.width / grid.columns, y: box.height / grid.rows };
    const path: string[] = [];
    for (let i = 1; i < grid.columns; ++i) path.push(`M${round(box.x + i * step.x)} ${round(box.y)}v${round(box.height)}`);
    for (let i = 1; i < grid.rows; ++i) path.push(`M${round(box.x)} ${round(box.y + i * step.y)}h${round(box.width)}`);
    written.push(`<path d="${path.join("")}" stroke="${ink}" stroke-opacity="0.6" fill="none"/>`);
  }
  const block = overlay.block;
  for (const cell of block?.cells ?? []) {
    const step = { x: box.width / (block as Block).columns, y: box.height / (block as Block).rows };
    const y = box.y + box.height - (cell.row + 1) * step.y;
    written.push(
      `<rect x="${round(box.x + cell.column * step.x)}" y="${round(y)}" width="${round(step.x)}" height="${round(step.y)}" ` +
        `fill="${toCss(theme.accent)}" fill-opacity="0.14" stroke="${toCss(theme.accent)}"/>`,
    );
  }
  for (const { from, to, isPeriodic } of borders(box, frame.box)) {
    written.push(
      `<path d="M${round(from.x)} ${round(from.y)}L${round(to.x)} ${round(to.y)}" fill="none" stroke="${ink}" ` +
        `stroke-width="${borderWidth(isPeriodic)}"${isPeriodic ? ' stroke-dasharray="6 4"' : ""}/>`,
    );
  }
  for (const wall of overlay.walls ?? []) {
    const [from, to] = [camera.toPixels(wall.from), camera.toPixels(wall.to)];
    written.push(
      `<path d="M${round(from.x)} ${round(from.y)}L${round(to.x)} ${round(to.y)}" fill="none" stroke="${ink}" stroke-width="${INNER_WALL_WIDTH}"/>`,
    );
  }
  const rings = [...(overlay.block?.near ?? []), ...(overlay.selected ?? [])].filter((row) => row < frame.count);
  for (const row of rings) {
    const at = camera.toPixels(positionAt(frame, row));
    const radius = Math.max(4, radiusAt(frame, row) * camera.scale);
    written.push(
      `<circle cx="${round(at.x)}" cy="${round(at.y)}" r="${round(radius + 1)}" fill="none" stroke="${toCss(theme.accent)}" stroke-width="2.5"/>`,
    );
  }
  return [...written, ...ruler(view)];
}

function ruler({ overlay, camera, theme }: View): string[] {
  if (overlay.ruler === undefined) return [];
  const from = camera.toPixels(overlay.ruler.from);
  const to = camera.toPixels(overlay.ruler.to);
  return [
    `<path d="M${round(from.x)} ${round(from.y)}L${round(to.x)} ${round(to.y)}" stroke="${toCss(theme.accent)}" stroke-width="2"/>`,
    `<text x="${round((from.x + to.x) / 2)}" y="${round((from.y + to.y) / 2 - 10)}" text-anchor="middle" fill="${toCss(theme.ink)}">${escaped(overlay.ruler.label)}</text>`,
  ];
}

function legend({ paint, theme, width, height }: View): string[] {
  const shown = paint.legend;
  if (shown.kind === "none") return [];
  const bar = legendRectangle(width, height);
  const ink = toCss(theme.ink);
  if (shown.kind === "list") {
    const y = height - LEGEND_HEIGHT / 2;
    const entries = shown.entries.flatMap((entry, i) => {
      const x = bar.x + 90 * i;
      return [
        `<rect x="${x}" y="${y - 6}" width="12" height="12" fill="${toCss(entry.colour)}" stroke="${ink}"/>`,
        `<text x="${x + 18}" y="${y + 4}" fill="${ink}">${escaped(entry.name)}</text>`,
      ];
    });
    return [`<text x="${bar.x - 12}" y="${y + 4}" text-anchor="end" fill="${ink}">${escaped(shown.label)}</text>`, ...entries];
  }
  const stops = shown.colours.map(
    (colour, i) => `<stop offset="${round(i / (shown.colours.length - 1))}" stop-color="${toCss(colour)}"/>`,
  );
  const marks = (shown.kind === "circle" ? CIRCLE_TICKS : ticks(shown.least, shown.most)).map(
    (tick) =>
      `<text x="${round(bar.x + tick.place * bar.width)}" y="${bar.y + 26}" text-anchor="middle" fill="${ink}">${tick.text}</text>`,
  );
  return [
    `<defs><linearGradient id="bar">${stops.filter((_, i) => i % 5 === 0).join("")}</linearGradient></defs>`,
    `<rect x="${bar.x}" y="${bar.y}" width="${bar.width}" height="${bar.height}" fill="url(#bar)"/>`,
    ...marks,
    `<text x="${bar.x - 12}" y="${bar.y + 10}" text-anchor="end" fill="${ink}">${escaped(shown.label)}</text>`,
  ];
}
