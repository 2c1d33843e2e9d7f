import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import type { Plugin } from "vite";

const folder = new URL("../build-web/engine/web/engine/", import.meta.url);
const publicName = "virtual:gridlock-engine";
const resolvedName = "\0" + publicName;

/** The module that Emscripten has made, with its WebAssembly as a text in it: gzip's bytes in base64. */
function engineSource(): string {
  const script = readFileSync(new URL("gridlock_engine.js", folder), "utf8")
    // It is given its bytes and looks for no file.
    .replace(/new URL\(["']gridlock_engine\.wasm["'], ?import\.meta\.url\)\.toString\(\)/g, '""')
    .replaceAll("import.meta.url", '""');
  const packed = gzipSync(readFileSync(new URL("gridlock_engine.wasm", folder)), { level: 9 }).toString("base64");
  return `${script}\nexport const packedModule = "${packed}";\n`;
}

/** Serves `virtual:gridlock-engine`: createEngine() and packedModule. */
export function engine(): Plugin {
  return {
    name: "gridlock-engine",
    resolveId: (id) => (id === publicName ? resolvedName : null),
    load(id) {
      if (id !== resolvedName) return null;
      const script = fileURLToPath(new URL("gridlock_engine.js", folder));
      if (!existsSync(script)) this.error("the engine is not built; ./dev build-web builds it");
      this.addWatchFile(script);
      return { code: engineSource(), map: null };
    },
  };
}
