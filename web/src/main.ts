import "./page/style.css";

import { Shell, type Panel } from "./page/shell.ts";
import { ThemeSwitch } from "./page/theme.ts";
import { isLive } from "./live/live_model.ts";
import { LiveView } from "./live/live_view.ts";
import { readFigure } from "./playground/figure.ts";
import { Playground } from "./playground/playground.ts";
import { isServed } from "./sources/served.ts";
import { acceptDrops } from "./viewer/drop.ts";
import { Viewer } from "./viewer/viewer.ts";
import "./viewer/style.css";

// "figure" is for a frame in another page: the picture of the playground, its keys, and what the address asks for besides; "viewer"
// begins with the viewer.
const view = new URLSearchParams(location.search).get("view");
const figure = view === "figure" ? readFigure(location.hash) : undefined;
document.documentElement.classList.toggle("as-figure", figure !== undefined);
// A figure is as light or dark as its frame.
const theme = new ThemeSwitch(figure === undefined);

const showVersion = (version: string): void => {
  shell.version = version;
};

const panels: Panel[] = [
  ...(isLive() ? [{ name: "Model", open: async () => theLiveView() }] : []),
  {
    name: "Playground",
    open: async () => {
      const playground = new Playground(theme, showVersion, figure);
      void playground.start();
      // For the console of the browser, and for tests.
      Object.assign(globalThis, { gridlock: { playground, drawing: playground.drawing } });
      return playground;
    },
  },
  { name: "Viewer", open: async () => theViewer() },
];
const VIEWER = panels.length - 1;

function theLiveView(): LiveView {
  const live = new LiveView(theme, showVersion);
  void live.start();
  Object.assign(globalThis, { gridlockLive: live });
  return live;
}

let viewer: Viewer | undefined;
function theViewer(): Viewer {
  if (viewer === undefined) {
    viewer = new Viewer(theme, showVersion);
    void viewer.start();
    Object.assign(globalThis, { gridlockViewer: viewer });
  }
  return viewer;
}

const shell = new Shell(document.getElementById("page") as HTMLElement, panels, theme);
void shell.show(isServed() || view === "viewer" ? VIEWER : 0);
acceptDrops((files) => {
  void shell.show(VIEWER);
  void theViewer().openFiles(files);
});
