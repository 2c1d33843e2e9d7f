"use strict";

// A figure that runs: the playground comes in place of the picture when a reader asks for it, for it is a megabyte. The page of one file is
// larger, and needs no server.
const playground = location.protocol.startsWith("http") ? "index.html" : "playground.html";
const figures = typeof WebAssembly === "object" ? document.querySelectorAll(".live-figure") : [];
for (const figure of figures) {
  const { setUp } = figure.dataset;
  const page = figure.dataset.folder + playground;
  const run = document.createElement("button");
  run.type = "button";
  run.textContent = "Run it here";
  run.addEventListener("click", () => {
    const frame = document.createElement("iframe");
    frame.src = `${page}?view=figure${setUp}&run=1`;
    frame.title = figure.querySelector("img")?.alt ?? "A run in the playground";
    frame.addEventListener("load", () => frame.focus()); // for those who work with keys
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
  const names = await answer.json();
  const here = root.pathname.split("/").at(-2);
  const goTo = async (name) => {
    const folder = new URL(`../${name}/`, root);
    const same = new URL(choice.dataset.page, folder);
    const there = await fetch(same, { method: "HEAD" });
    location.assign(there.ok ? same : new URL("index.html", folder));
  };
  for (const name of names) choice.append(new Option(name, name, name === here, name === here));
  choice.addEventListener("change", () => void goTo(choice.value));
  choice.parentElement.hidden = false;
  if (here === names[0]) return;
  const note = document.createElement("p");
  note.className = "version-note";
  const newest = document.createElement("button");
  newest.type = "button";
  newest.textContent = `see ${names[0]}, the newest release`;
  newest.addEventListener("click", () => void goTo(names[0]));
  note.append(`This page describes ${here}: `, newest);
  document.querySelector("article h1")?.after(note);
}
if (location.protocol.startsWith("http") && choice !== null) void offerVersions().catch(() => {});
