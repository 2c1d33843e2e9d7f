import "./page/style.css";

import { Shell, type Panel } from "./page/shell.ts";
import { ThemeSwitch } from "./page/theme.ts";
import { Playground } from "./playground/playground.ts";

const theme = new ThemeSwitch();

const panels: Panel[] = [
  {
    name: "Playground",
    open: async () => {
      const playground = new Playground(theme);
      void playground.start();
      // For the console of the browser, and for tests.
      Object.assign(globalThis, { gridlock: { playground, drawing: playground.drawing } });
      return playground;
    },
  },
];

const shell = new Shell(document.getElementById("page") as HTMLElement, panels, theme);
void shell.show(0);
