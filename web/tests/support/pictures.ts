/** Pictures compared with references that are kept. */

import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import pixelmatch from "pixelmatch";
import { PNG } from "pngjs";

const FOLDER = join(import.meta.dirname, "../page/references");
const FAILED = join(import.meta.dirname, "../../../build-web/pictures");

/** The share of pixels that differ visibly; 1 for pictures of different sizes. */
export function shareOfDifferences(one: PNG, other: PNG, marked?: PNG): number {
  if (one.width !== other.width || one.height !== other.height) return 1;
  return pixelmatch(one.data, other.data, marked?.data, one.width, one.height, { threshold: 0.15 }) / (one.width * one.height);
}

export function reference(name: string): PNG {
  return PNG.sync.read(readFileSync(join(FOLDER, `${name}.png`)));
}

/**
 * The share of pixels in which a picture differs from its reference. GRIDLOCK_WRITE_REFERENCES=1 makes the picture the reference. What
 * differs is kept in build-web/pictures.
 */
export function differenceFromReference(name: string, bytes: Buffer): number {
  if (process.env["GRIDLOCK_WRITE_REFERENCES"] === "1") {
    mkdirSync(FOLDER, { recursive: true });
    writeFileSync(join(FOLDER, `${name}.png`), bytes);
  }
  if (!existsSync(join(FOLDER, `${name}.png`)))
    throw new Error(`there is no reference ${name}.png; GRIDLOCK_WRITE_REFERENCES=1 writes it`);
  const now = PNG.sync.read(bytes);
  const kept = reference(name);
  const marked = new PNG({ width: now.width, height: now.height });
  const share = shareOfDifferences(now, kept, marked);
  if (share > 0) {
    mkdirSync(FAILED, { recursive: true });
    writeFileSync(join(FAILED, `${name}.png`), bytes);
    writeFileSync(join(FAILED, `${name}.differences.png`), PNG.sync.write(marked));
  }
  return share;
}
