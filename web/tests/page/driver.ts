/** What a user does in the playground, in words of the page. */

import type { Page } from "playwright-core";

export class PlaygroundDriver {
  readonly page: Page;

  constructor(page: Page) {
    this.page = page;
  }

  /** Waits until a run is drawn. */
  async ready(): Promise<void> {
    await this.page.waitForFunction(() => (document.querySelector(".status code")?.textContent ?? "").length === 16, undefined, {
      timeout: 30_000,
    });
  }

  async step(): Promise<number> {
    const text = await this.page.locator(".status span").first().locator("b").innerText();
    return Number(text.replaceAll(/\D/g, ""));
  }

  /** Of the state where the run is paused. */
  async hash(): Promise<string> {
    await this.page.waitForFunction(() => (document.querySelector(".status code")?.textContent ?? "").length === 16);
    return this.page.locator(".status code").innerText();
  }

  async press(name: string): Promise<void> {
    await this.page.getByRole("button", { name, exact: true }).click();
  }

  /** Runs until a step is passed, then pauses. */
  async runPast(step: number): Promise<void> {
    await this.press("Run");
    await this.page.waitForFunction(
      (least) => Number((document.querySelector(".status span b")?.textContent ?? "").replaceAll(/\D/g, "")) > least,
      step,
      { timeout: 60_000 },
    );
    // A run that has come to its end has no key to pause it.
    const pause = this.page.getByRole("button", { name: "Pause", exact: true });
    if (await pause.isVisible()) await pause.click();
    await this.ready();
  }

  async chooseScene(name: string): Promise<void> {
    await this.page.getByRole("combobox", { name: "Scene" }).selectOption(name);
    await this.opened();
  }

  /** Waits for the frame of a set-up that was just opened: at step 0, with its hash. */
  async opened(): Promise<void> {
    await this.page.waitForFunction(() => document.querySelector(".status span b")?.textContent === "0", undefined, {
      timeout: 30_000,
    });
    await this.ready();
  }

  async openToml(toml: string): Promise<void> {
    const details = this.page.locator("details", { has: this.page.getByText("Set-up as TOML", { exact: true }) });
    if (!(await details.evaluate((element: HTMLDetailsElement) => element.open))) await details.locator("summary").click();
    await this.page.getByRole("textbox", { name: "The set-up as TOML" }).fill(toml);
    await this.press("Set up");
  }

  /** Types a number beside a slider. */
  async setNumber(label: string, value: number): Promise<void> {
    const field = this.page.getByRole("spinbutton", { name: label });
    await field.fill(String(value));
    await field.press("Enter");
    await field.blur();
  }

  async colourBy(name: string): Promise<void> {
    await this.page.getByRole("combobox", { name: "Colour by" }).selectOption(name);
  }

  /** How many different colours the middle of the picture has; 1 for an empty one. */
  async coloursInPicture(): Promise<number> {
    return this.page.evaluate(() => {
      const source = document.querySelector(".picture canvas") as HTMLCanvasElement;
      const canvas = document.createElement("canvas");
      // Its middle: reading all of it takes longer than drawing it.
      const side = 300;
      canvas.width = side;
      canvas.height = side;
      const context = canvas.getContext("2d", { willReadFrequently: true }) as CanvasRenderingContext2D;
      context.drawImage(source, (source.width - side) / 2, (source.height - side) / 2, side, side, 0, 0, side, side);
      return new Set(new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
    });
  }
}
