/** What the page and the worker of the engine send each other. */

import type { ErrorKind, Named, Problem, SettingDescription } from "./gridlock.ts";
import type { EngineFrame } from "./engine_client.ts";

/** A call: the name of a function of the worker and its arguments. */
export interface Request {
  readonly id: number;
  readonly call: string;
  readonly args: readonly unknown[];
}

/** An error as it crosses: the classes of errors do not. */
export interface SentError {
  readonly kind: ErrorKind;
  readonly problems: readonly Problem[];
}

export interface Catalogue {
  readonly version: string;
  readonly settings: readonly SettingDescription[];
  readonly models: readonly Named[];
  readonly engines: readonly Named[];
}

export type Reply =
  | { readonly type: "value"; readonly id: number; readonly value: unknown }
  | { readonly type: "error"; readonly id: number; readonly error: SentError }
  | { readonly type: "frame"; readonly frame: EngineFrame }
  | { readonly type: "failure"; readonly error: SentError };
