import { createHash } from "node:crypto";
import type { Plugin } from "vite";

/**
 * Writes the page a second time, as one file with the script and the style in it: playground.html can be opened from a disk, sent
 * and kept beside a report, where browsers load no modules from other files. Servers have index.html, whose scripts are files, as
 * strict rules for contents want it; the one script of playground.html is allowed by its hash.
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
