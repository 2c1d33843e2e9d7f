import { element, icon, type IconName } from "./dom.ts";

export interface MenuItem {
  readonly name: string;
  readonly hint: string;
  act(): void | Promise<void>;
}

/** A button that opens a list of actions; Escape and a click beside it close it, arrows walk it. */
export function menu(label: string, picture: IconName, items: () => readonly MenuItem[]): HTMLElement {
  const list = element("div", { class: "menu-items", role: "menu", hidden: true });
  const button = element(
    "button",
    {
      type: "button",
      class: "icon-button",
      "aria-label": label,
      title: label,
      "aria-haspopup": "menu",
      "aria-expanded": "false",
    },
    icon(picture),
  );
  const open = (isOpen: boolean): void => {
    list.hidden = !isOpen;
    button.setAttribute("aria-expanded", String(isOpen));
    if (!isOpen) return;
    list.replaceChildren(
      ...items().map((item) =>
        element(
          "button",
          {
            type: "button",
            role: "menuitem",
            onclick: () => {
              open(false);
              button.focus();
              void item.act();
            },
          },
          item.name,
          element("small", {}, item.hint),
        ),
      ),
    );
    (list.firstElementChild as HTMLElement | null)?.focus();
  };
  button.addEventListener("click", () => open(list.hidden !== false));
  const host = element("div", { class: "menu" }, button, list);
  host.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !list.hidden) {
      open(false);
      button.focus();
    }
    const by = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (by === 0 || list.hidden) return;
    const all = [...list.children] as HTMLElement[];
    all[(all.indexOf(document.activeElement as HTMLElement) + by + all.length) % all.length]?.focus();
    event.preventDefault();
  });
  document.addEventListener("pointerdown", (event) => {
    if (!host.contains(event.target as Node)) open(false);
  });
  return host;
}
