import { createHash } from "node:crypto";
import { build, type LogLevel, type Plugin } from "vite";

/** The mode of the build of playground.html. */
export const SINGLE_FILE = "single-file";

/**
 * The page for servers: index.html, whose scripts are files, as strict rules for contents want it. Workers are files too, so that the
 * engines and HDF5 are fetched only when they are needed, and the first picture does not wait for them. Builds playground.html as well.
 */
export function folder(): Plugin {
  let logLevel: LogLevel | undefined;
  return {
    name: "gridlock-folder",
    apply: "build",
    enforce: "pre",
    configResolved: (config) => { logLevel = config.logLevel; },
    transform: (code) => (code.includes("?worker&inline") ? { code: code.replaceAll("?worker&inline", "?worker"), map: null } : null),
    closeBundle: async () => { await build({ mode: SINGLE_FILE, ...(logLevel === undefined ? {} : { logLevel }) }); },
  };
}

/**
 * Makes playground.html: the page as one file with the scripts, the workers and the style in it, which can be opened from a disk, sent and
 * kept beside a report, where browsers load no modules from other files. Its one script is allowed by its hash.
 */
export function singleFile(): Plugin {
  return {
    name: "gridlock-single-file",
    apply: "build",
    enforce: "post",
    generateBundle(_options, bundle) {
      const page = bundle["index.html"];
      if (page?.type !== "asset") return this.error("the build has made no index.html");
      let html = String(page.source);
      for (const part of Object.values(bundle)) {
        const text = part.type === "chunk" ? inlineScript(part.code) : inlineStyle(part.fileName, String(part.source));
        if (text === null) continue;
        const tag = new RegExp(`<(script|link)[^>]*(src|href)="[^"]*${part.fileName}"[^>]*>(</script>)?`);
        html = html.replace(tag, () => text);
      }
      for (const name of Object.keys(bundle)) delete bundle[name];
      this.emitFile({ type: "asset", fileName: "playground.html", source: allowInlineScripts(html) });
    },
  };
}

function inlineScript(code: string): string {
  return `<script type="module">${code.replaceAll("</script", "<\\/script")}</script>`;
}

function inlineStyle(fileName: string, code: string): string | null {
  return fileName.endsWith(".css") ? `<style>${code}</style>` : null;
}

/** Puts the hashes of the scripts of a page into its Content-Security-Policy. */
function allowInlineScripts(html: string): string {
  const hashes = [...html.matchAll(/<script type="module">([\s\S]*?)<\/script>/g)].map(
    ([, code]) => `'sha256-${createHash("sha256").update(code as string).digest("base64")}'`,
  );
  return html.replace("script-src 'self'", `script-src ${hashes.join(" ")}`);
}
