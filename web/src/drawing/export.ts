/** Offers a file to the user. */
export function download(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const VIDEO_TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];

const LONGEST_WAIT = 10_000; // milliseconds

/** A video of pictures that are added one by one, in the time they are added. */
export class Recording {
  private readonly canvas = document.createElement("canvas");
  private readonly context: CanvasRenderingContext2D;
  private readonly recorder: MediaRecorder;
  private readonly parts: Blob[] = [];

  /** Throws Error where the browser records no video. */
  constructor(width: number, height: number, framesPerSecond: number) {
    this.canvas.width = width + (width % 2); // encoders want even sizes
    this.canvas.height = height + (height % 2);
    this.context = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    const type = VIDEO_TYPES.find((one) => typeof MediaRecorder !== "undefined" && MediaRecorder.isTypeSupported(one));
    if (type === undefined) throw new Error("this browser records no video; use `gridlock movie` or another browser");
    this.recorder = new MediaRecorder(this.canvas.captureStream(framesPerSecond), { mimeType: type, videoBitsPerSecond: 12e6 });
    this.recorder.ondataavailable = (event) => this.parts.push(event.data);
    this.recorder.start(1000);
  }

  add(picture: HTMLCanvasElement): void {
    this.context.drawImage(picture, 0, 0, this.canvas.width, this.canvas.height);
  }

  async stop(): Promise<Blob> {
    await this.waitForPictures();
    const stopped = new Promise((resolve) => {
      this.recorder.onstop = resolve;
    });
    this.recorder.stop();
    await stopped;
    for (const track of this.recorder.stream.getTracks()) track.stop();
    return new Blob(this.parts, { type: this.recorder.mimeType });
  }

  /** A recorder that is stopped before its encoder has finished a picture gives an empty file. */
  private async waitForPictures(): Promise<void> {
    const end = performance.now() + LONGEST_WAIT;
    while (this.parts.every((part) => part.size === 0) && performance.now() < end) {
      this.context.drawImage(this.canvas, 0, 0); // a picture that is the same counts as one
      this.recorder.requestData();
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
  }
}

/** How files of a video end, by its type. */
export function videoEnding(video: Blob): string {
  return video.type.startsWith("video/mp4") ? "mp4" : "webm";
}
