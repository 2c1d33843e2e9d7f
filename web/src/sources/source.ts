/** Where frames come from: a run that is served, or a file that was dropped on the page. */

import type { Box, Field, Numbers } from "../drawing/frame.ts";
import type { Wall } from "../drawing/walls.ts";

/** A quantity with a value at some of the times: an observable, or a column of series.csv. */
export interface Quantity {
  readonly name: string;
  readonly unit: string;
  /** One for each of the times; NaN where it was not measured. */
  readonly values: readonly number[];
}

/** Quantities against time. */
export interface QuantityTable {
  readonly times: readonly number[];
  readonly quantities: readonly Quantity[];
}

/** By the name of a column. */
export type ValueNames = Readonly<Record<string, readonly string[]>>;

/** What a source holds, without the agents themselves. */
export interface Description {
  /** What the agents are called: "disks". */
  readonly agents: string;
  readonly columns: readonly string[];
  /** What the numbers 0, 1, 2 … of a column are called, where the file says. */
  readonly valueNames?: ValueNames;
  /** Of each frame; NaN where the file does not say. */
  readonly steps: readonly number[];
  readonly times: readonly number[];
  readonly table: QuantityTable;
  /** What a user should know of the file, such as frames that are missing. */
  readonly notes: readonly string[];
  /** Those inside the box, where the settings of the run are known. */
  readonly walls?: readonly Wall[];
  /** The names of the fields of a model, grids of numbers over the box. */
  readonly fields?: readonly string[];
}

/** All agents at one step. */
export interface SourceFrame {
  readonly step: number;
  readonly time: number;
  readonly box: Box;
  readonly ids: Float64Array;
  /** Of one length with `ids`; "x" and "y" are always there. */
  readonly columns: Readonly<Record<string, Numbers>>;
  /** 16 hexadecimal digits, where it is known. */
  readonly stateHash: string;
  /** Of the names that the description has. */
  readonly fields?: Readonly<Record<string, Field>>;
}

/**
 * Frames in order, more of them while a run is written.
 *
 * All promises reject with a SourceError, whose message is for the user.
 */
export interface FrameSource {
  readonly name: string;
  readonly description: Description;
  /** Whether more frames may come: then refresh() is worth asking. */
  readonly isGrowing: boolean;
  /** "finished", "unfinished", "abandoned" and so on, of a run; empty for a file. */
  readonly status: string;
  /** Looks for more; true where the description has changed. */
  refresh(): Promise<boolean>;
  frame(index: number): Promise<SourceFrame>;
  close(): void;
}

/** Something that cannot be shown, in words for the user. */
export class SourceError extends Error {
  constructor(message: string, readonly hint = "") {
    super(message);
    this.name = "SourceError";
  }
}

/** The first letters of a text that may be of any length. */
export function cut(text: string): string {
  return text.length > MOST_LETTERS ? `${text.slice(0, MOST_LETTERS)}…` : text;
}
const MOST_LETTERS = 30;

/** The error as a message with its hint. */
export function textOf(error: unknown): string {
  if (error instanceof SourceError && error.hint !== "") return `${error.message}\n${error.hint}`;
  return error instanceof Error ? error.message : String(error);
}

/** The number of the frame whose time is nearest; 0 where there is none. */
export function frameAtTime(times: readonly number[], time: number): number {
  let nearest = 0;
  times.forEach((one, index) => {
    if (Math.abs(one - time) < Math.abs((times[nearest] as number) - time)) nearest = index;
  });
  return nearest;
}
