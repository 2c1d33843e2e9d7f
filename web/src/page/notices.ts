import { element } from "./dom.ts";

const region = element("div", { role: "status", "aria-live": "polite" });

/** Says something for a moment. */
export function notice(text: string): void {
  if (!region.isConnected) document.body.append(region);
  const toast = element("div", { class: "toast" }, text);
  region.replaceChildren(toast);
  setTimeout(() => toast.remove(), 2600);
}

/** Copies a text, and says so. */
export async function copy(text: string, what: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    notice(`${what} copied`);
  } catch {
    notice(`The browser allows no copying: ${text}`);
  }
}
