import { element } from "../page/dom.ts";

/** Files that are dropped anywhere on the page. */
export function acceptDrops(open: (files: readonly File[]) => void): void {
  const curtain = element("div", { class: "drop-curtain", hidden: true }, "Drop a trajectory: H5MD (.h5) or extended XYZ");
  const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  document.body.append(curtain);
  document.addEventListener("dragover", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    curtain.hidden = false;
  });
  document.addEventListener("dragleave", (event) => { if (event.relatedTarget === null) curtain.hidden = true; });
  document.addEventListener("drop", (event) => {
    curtain.hidden = true;
    if (!hasFiles(event)) return;
    event.preventDefault();
    open([...(event.dataTransfer?.files ?? [])]);
  });
}
