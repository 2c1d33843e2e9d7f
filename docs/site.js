"use strict";

// A figure that runs: the playground comes in place of the picture when a reader asks for it, for it is two megabytes.
for (const figure of document.querySelectorAll(".live-figure")) {
  const { page, setUp } = figure.dataset;
  const run = document.createElement("button");
  run.type = "button";
  run.textContent = "Run it here";
  run.addEventListener("click", () => {
    const frame = document.createElement("iframe");
    frame.src = `${page}?view=figure${setUp}`;
    frame.title = figure.querySelector("img")?.alt ?? "A run in the playground";
    figure.querySelector("img")?.closest("p, figure, a")?.replaceWith(frame);
    run.remove();
  });
  const whole = document.createElement("a");
  whole.href = page + setUp;
  whole.textContent = "open it in the playground";
  figure.append(run, whole);
}

// A choice of versions, where the site has several: docs/versions.py writes their list beside their folders.
const choice = document.getElementById("version");
async function offerVersions() {
  const root = new URL(document.documentElement.dataset.content_root, location.href); // the folder of this version
  const answer = await fetch(new URL("../versions.json", root));
  if (!answer.ok) return;
  const here = root.pathname.split("/").at(-2);
  for (const name of await answer.json()) choice.append(new Option(name, name, name === here, name === here));
  choice.addEventListener("change", async () => {
    const folder = new URL(`../${choice.value}/`, root);
    const same = new URL(choice.dataset.page, folder);
    const there = await fetch(same, { method: "HEAD" });
    location.assign(there.ok ? same : new URL("index.html", folder));
  });
  choice.parentElement.hidden = false;
}
if (location.protocol.startsWith("http") && choice !== null) void offerVersions().catch(() => {});
