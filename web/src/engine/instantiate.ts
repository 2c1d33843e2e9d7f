/** Makes the modules of WebAssembly that `vite_engine.ts` serves. */

/** Makes an instance with these imports and hands it over. */
export type InstantiateWasm = (
  imports: WebAssembly.Imports,
  done: (instance: WebAssembly.Instance, module: WebAssembly.Module) => void,
) => Record<string, never>;

/** What `create` of a packed module resolves to. Rejects where the browser cannot make it. */
export async function instantiate<Module>(
  create: (options: { instantiateWasm: InstantiateWasm }) => Promise<Module>,
  packedModule: string,
): Promise<Module> {
  return new Promise((resolve, reject) => {
    // Emscripten waits for `done` and knows of no failure.
    const instantiateWasm: InstantiateWasm = (imports, done) => {
      WebAssembly.instantiateStreaming(unpacked(packedModule), imports).then(({ instance, module }) => done(instance, module), reject);
      return {};
    };
    create({ instantiateWasm }).then(resolve, reject);
  });
}

/** Compiled while the rest is unpacked. */
function unpacked(base64: string): Response {
  const letters = atob(base64);
  const bytes = new Uint8Array(letters.length);
  for (let at = 0; at < letters.length; ++at) bytes[at] = letters.charCodeAt(at);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream, { headers: { "Content-Type": "application/wasm" } });
}
