import type { Series } from "../charts/series.ts";
import type { Drawing } from "../drawing/drawing.ts";
import { download, videoEnding } from "../drawing/export.ts";
import type { MenuItem } from "../page/menu.ts";
import { notice } from "../page/notices.ts";

/** What can be taken home from a run. */
export interface Exported {
  readonly drawing: Drawing;
  readonly series: Series;
  /** Of files, without an ending. */
  readonly name: string;
  /** The whole set-up, and the step it has come to. */
  readonly toml: string;
  readonly step: number;
}

const text = (content: string, type: string): Blob => new Blob([content], { type });

export function exportItems(run: Exported): MenuItem[] {
  const { drawing, name } = run;
  const guarded = (act: () => Promise<void> | void) => async (): Promise<void> => {
    try {
      await act();
    } catch (error) {
      notice(error instanceof Error ? error.message : String(error));
    }
  };
  return [
    {
      name: "Picture, PNG",
      hint: "the view, twice as sharp as on the screen",
      act: guarded(() => drawing.save("png", `${name}_${run.step}`)),
    },
    {
      name: "Picture, SVG",
      hint: "the view as shapes, for papers",
      act: guarded(() => drawing.save("svg", `${name}_${run.step}`)),
    },
    drawing.isRecording
      ? { name: "End the video", hint: "and save it", act: guarded(() => saveVideo(drawing, name)) }
      : {
          name: "Begin a video",
          hint: "of all that is shown until you end it here",
          act: guarded(() => {
            drawing.startRecording();
            notice("The video has begun");
          }),
        },
    {
      name: "Series, CSV",
      hint: run.series.isThinned ? "the samples of the charts, thinned" : "every sample, as in series.csv",
      act: () => download(text(run.series.toCsv(), "text/csv"), `${name}_series.csv`),
    },
    {
      name: "Set-up, TOML",
      hint: `gridlock run ${name}.toml --set run.steps=${run.step}`,
      act: () => download(text(run.toml, "application/toml"), `${name}.toml`),
    },
  ];
}

async function saveVideo(drawing: Drawing, name: string): Promise<void> {
  const video = await drawing.stopRecording();
  download(video, `${name}.${videoEnding(video)}`);
}
