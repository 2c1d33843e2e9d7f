/** Colours that people with any common colour blindness tell apart: those of apps/drawing, so that movies and the page agree. */

/** Red, green and blue of sRGB, each from 0 to 1. */
export type Colour = readonly [number, number, number];

export const WHITE: Colour = [1, 1, 1];

function fromHex(hex: number): Colour {
  return [(hex >> 16) / 255, ((hex >> 8) & 0xff) / 255, (hex & 0xff) / 255];
}

export function mixed(from: Colour, to: Colour, share: number): Colour {
  const part = (i: 0 | 1 | 2): number => from[i] + share * (to[i] - from[i]);
  return [part(0), part(1), part(2)];
}

export function toCss(colour: Colour): string {
  const byte = (part: number): string =>
    Math.round(255 * part)
      .toString(16)
      .padStart(2, "0");
  return `#${byte(colour[0])}${byte(colour[1])}${byte(colour[2])}`;
}

/** Eight colours in the order curves take them. Source: M. Okabe & K. Ito, Color Universal Design (2008). */
export const OKABE_ITO: readonly Colour[] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x000000, 0xf0e442].map(
  fromHex,
);

const okabeIto = (i: number): Colour => OKABE_ITO[i] as Colour;

/** Colours of kinds on disks: a little lighter, so that the black one shows its outline. */
export const KIND_COLOURS: readonly Colour[] = OKABE_ITO.map((colour) => mixed(colour, WHITE, 0.15));

/** The four colours of an even grid come first; the five others appear on odd periodic rings. */
export const NEIGHBOURHOOD_COLOURS: readonly Colour[] = [
  mixed(okabeIto(0), WHITE, 0.25),
  mixed(okabeIto(4), WHITE, 0.15),
  mixed(okabeIto(1), WHITE, 0.1),
  mixed(okabeIto(2), WHITE, 0.2),
  mixed(okabeIto(3), WHITE, 0.1),
  mixed(okabeIto(5), WHITE, 0.2),
  okabeIto(7),
  [0.55, 0.55, 0.55],
  [0.45, 0.26, 0.18],
];

export const UNKNOWN_VALUE: Colour = [0.75, 0.75, 0.75];

const VIRIDIS = [
  0x440154, 0x481769, 0x472a7a, 0x433d84, 0x3d4e8a, 0x355e8d, 0x2e6d8e, 0x297b8e, 0x23898e, 0x1f978b, 0x21a585, 0x2eb37c,
  0x46c06f, 0x65cb5e, 0x89d548, 0xb0dd2f, 0xd8e219, 0xfde725,
].map(fromHex);

/** Source: J. R. Nuñez et al. 2018, doi:10.1371/journal.pone.0199239. */
const CIVIDIS = [
  0x00224e, 0x002d68, 0x163770, 0x2e416d, 0x3f4c6c, 0x4e566c, 0x5c616e, 0x696b71, 0x767676, 0x838179, 0x928c78, 0xa09875,
  0xafa471, 0xbfb06b, 0xcfbd62, 0xdfca57, 0xf0d846, 0xfee838,
].map(fromHex);

function along(anchors: readonly Colour[], t: number): Colour {
  const share = t > 0 ? Math.min(t, 1) : 0; // and 0 for nan
  const place = share * (anchors.length - 1);
  const below = Math.min(Math.floor(place), anchors.length - 2);
  return mixed(anchors[below] as Colour, anchors[below + 1] as Colour, place - below);
}

/** From dark blue (t = 0) over green to yellow (t = 1). Source: van der Walt & Smith, SciPy 2015. */
export function viridis(t: number): Colour {
  return along(VIRIDIS, t);
}

/** From dark blue over grey to yellow: the same to people with and without colour blindness. */
export function cividis(t: number): Colour {
  return along(CIVIDIS, t);
}

/** Hues around a circle with the same colour at both ends; one side is brighter. Source: B. Ottosson, oklab (2020). */
export function colourCircle(t: number): Colour {
  const angle = 2 * Math.PI * t;
  const chroma = 0.12;
  const lightness = 0.7 + 0.12 * Math.cos(angle - 1.9); // brightest at yellow, where there are bright colours
  const a = chroma * Math.cos(angle);
  const b = chroma * Math.sin(angle);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const encoded = (x: number): number => {
    const part = Math.min(Math.max(x, 0), 1);
    return part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055;
  };
  return [
    encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    encoded(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

export type ScaleName = "viridis" | "cividis";

export const SCALES: Readonly<Record<ScaleName, (t: number) => Colour>> = { viridis, cividis };
