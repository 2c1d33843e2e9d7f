/** The worker: serves the calls of the page one after the other, and runs the simulation in between. */

import { GridlockError } from "./gridlock.ts";
import type { Reply, Request, SentError } from "./protocol.ts";
import { Simulator } from "./simulator.ts";

declare const self: DedicatedWorkerGlobalScope;

const post = (reply: Reply, transfer: Transferable[] = []): void => self.postMessage(reply, transfer);

const simulator = new Simulator({
  frame: (frame) => {
    const arrays = [frame.ids, frame.positions, frame.radii, frame.colour, frame.series];
    post({ type: "frame", frame }, arrays.map((array) => array.buffer as ArrayBuffer));
  },
  failure: (error) => post({ type: "failure", error: sent(error) }),
});

function sent(error: unknown): SentError {
  if (error instanceof GridlockError) return { kind: error.kind, problems: error.problems };
  const text = error instanceof Error ? error.message : String(error);
  return { kind: "internal", problems: [{ what: text, hint: "", key: "", line: 0, column: 0, sourceLine: "", text }] };
}

let last: Promise<void> = Promise.resolve();

async function serve({ id, call, args }: Request): Promise<void> {
  try {
    const method = (simulator as unknown as Record<string, (...args: unknown[]) => unknown>)[call];
    if (method === undefined) throw new Error(`the engine has no function ${call}`);
    post({ type: "value", id, value: await method.apply(simulator, [...args]) });
  } catch (error) {
    post({ type: "error", id, error: sent(error) });
  }
}

self.onmessage = ({ data }: MessageEvent<Request>): void => {
  // A frame that has been drawn makes room for the next at once, also during a long call.
  if (data.call === "frameDrawn") simulator.frameDrawn();
  else last = last.then(() => serve(data));
};
