import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import type { Plugin } from "vite";

const folder = new URL("../build-web/engine/web/engine/", import.meta.url);
/** The modules of web/engine/CMakeLists.txt by the names that scripts import. */
const MODULES: Readonly<Record<string, string>> = { "virtual:gridlock-engine": "gridlock_engine", "virtual:gridlock-xyz": "gridlock_xyz" };

/** A module that Emscripten has made, with its WebAssembly as a text in it: gzip's bytes in base64. */
function sourceOf(name: string): string {
  const script = readFileSync(new URL(`${name}.js`, folder), "utf8")
    // It is given its bytes and looks for no file.
    .replace(new RegExp(`new URL\\(["']${name}\\.wasm["'], ?import\\.meta\\.url\\)\\.toString\\(\\)`, "g"), '""')
    .replaceAll("import.meta.url", '""');
  const packed = gzipSync(readFileSync(new URL(`${name}.wasm`, folder)), { level: 9 }).toString("base64");
  return `${script}\nexport const packedModule = "${packed}";\n`;
}

/** Serves `virtual:gridlock-engine` and `virtual:gridlock-xyz`: a function that makes the module, and packedModule. */
export function engine(): Plugin {
  return {
    name: "gridlock-engine",
    resolveId: (id) => (id in MODULES ? `\0${id}` : null),
    load(id) {
      const name = id.startsWith("\0") ? MODULES[id.slice(1)] : undefined;
      if (name === undefined) return null;
      const script = fileURLToPath(new URL(`${name}.js`, folder));
      if (!existsSync(script)) this.error(`${name} is not built; ./dev build-web builds it`);
      this.addWatchFile(script);
      return { code: sourceOf(name), map: null };
    },
  };
}
