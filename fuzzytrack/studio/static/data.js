/* The pane of own data: a recording is dropped or chosen, tracked, compared, and tuned on. */

import { makeChart } from "./chart.js";
import { html, select } from "./elements.js";
import { action, group, numberField } from "./fields.js";
import { figure } from "./figure.js";
import { shown } from "./numbers.js";
import { trackerList } from "./pick.js";
import { swatch } from "./lines.js";
import { makeTrackPicture } from "./trackpicture.js";

export const title = "Own data";
// The server takes messages of up to 1 MiB; larger files are opened from the folder.
const MOST_BYTES = 1_000_000;

export function mount(element, app) {
  const { store, socket, say } = app;
  const chosen = select("Recording", [], "", (name) => store.set({ recording: name || null }));
  const input = html("input", { type: "file", accept: ".csv,.txt,text/csv", class: "unseen", tabindex: -1, "aria-hidden": "true", onchange: () => take(input.files[0]) });
  const drop = html(
    "button",
    { type: "button", class: "drop", onclick: () => input.click() },
    "Drop a CSV file here, or press to choose one",
  );
  const sigma = numberField("Plot σ", "m", (value) => store.set({ sigma: value }), {
    least: 0,
    title: "Standard deviation of the plots; found from the plots, or their columns, if it is left empty",
  });
  sigma.input.placeholder = "auto";
  const automatic = html("button", { type: "button", class: "quiet", onclick: () => store.set({ sigma: null }) }, "auto");
  const picks = trackerList(app);
  const compare = action("Track and compare", run, { class: "primary" });
  const facts = html("p", { class: "muted" });
  const notes = html("ul", { class: "notes" });
  const table = html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Comparison" });
  const which = select("Track", [], "", (value) => store.set({ trackShown: Number(value) }));
  const axis = select("Axis", [], "", (value) => store.set({ axisShown: Number(value) }));
  const lines = () => Object.keys(shownTrack(store.now).trackers).map((name, index) => [name, index]);
  const innovations = makeChart();
  const picture = makeTrackPicture("Recorded track", () => layerOf(store.now));
  const body = html(
    "div",
    { class: "tall", hidden: true },
    facts,
    notes,
    table,
    html(
      "div",
      { class: "pictures" },
      figure(app, "Tracks", "data-tracks", picture, lines, [which]),
      figure(app, "Innovations", "data-innovations", innovations, lines, [axis]),
    ),
  );
  const empty = html(
    "div",
    { class: "nothing" },
    html("p", {}, "Drop a CSV file with columns of time and position (t, x, y; or as `fuzzytrack track` takes them), or choose one in the folder."),
  );

  element.append(
    html("header", {}, html("h2", {}, title), html("span", { class: "space" }), compare),
    html(
      "div",
      { class: "beside" },
      html("div", { class: "tall" }, empty, body),
      html(
        "div",
        { class: "side" },
        group("Recording", drop, input, html("label", { class: "field" }, html("span", { class: "label" }, "File"), chosen), html("div", { class: "with-button" }, sigma.element, automatic)),
        group("Trackers", picks.element),
      ),
    ),
  );

  for (const kind of ["dragover", "dragleave", "drop"]) {
    element.addEventListener(kind, (event) => {
      event.preventDefault();
      drop.classList.toggle("over", kind === "dragover");
      if (kind === "drop") take(event.dataTransfer.files[0]);
    });
  }

  async function take(file) {
    input.value = "";
    if (!file) return;
    if (file.size > MOST_BYTES) {
      say(`${file.name} has ${shown(file.size / 1e6, 3)} MB; at most 1 MB can be dropped. Put it into the folder and choose it.`, "error");
      return;
    }
    try {
      const found = await socket.send("upload", { name: file.name, text: await file.text() });
      store.set({ uploads: [...new Set([...store.now.uploads, found.name])], recording: found.name });
      await run();
    } catch (error) {
      say(error.message, "error");
    }
  }

  async function run() {
    const { recording, trackers, sigma: given } = store.now;
    const texts = trackers.filter(({ on }) => on).map(({ text }) => text);
    if (!recording) return say("There is no recording: drop a CSV file, or choose one in the folder.", "error");
    if (!texts.length) return say("No tracker is chosen: check one in the list, or add one.", "error");
    try {
      const tracked = await socket.send("track", { name: recording, trackers: texts, sigma: given });
      store.set({ tracked, trackShown: 0, axisShown: 0 });
      say(`${recording}: ${tracked.plots} plots.`);
    } catch (error) {
      say(error.message, "error");
    }
  }

  store.follow(["files", "uploads", "recording"], ({ files, uploads, recording }) => {
    const names = [...new Set([...uploads, ...files.filter(({ kind }) => kind === "recording").map(({ name }) => name)])];
    chosen.replaceChildren(html("option", { value: "" }, "none"), ...names.map((name) => html("option", { value: name }, name)));
    chosen.value = names.includes(recording) ? recording : "";
  });
  store.follow(["sigma"], ({ sigma: given }) => sigma.show(given));
  store.follow(["tracked", "trackShown", "axisShown", "scheme", "view"], (now) => {
    const { tracked, trackShown, axisShown } = now;
    body.hidden = !tracked;
    empty.hidden = Boolean(tracked);
    if (!tracked) return;
    facts.textContent = factsOf(tracked);
    notes.replaceChildren(...(tracked.notes ?? []).map((text) => html("li", {}, text)));
    table.replaceChildren(comparisonTable(tracked));
    which.replaceChildren(...tracked.tracks.map(({ id }, k) => html("option", { value: k }, `track ${id}`)));
    which.value = String(trackShown);
    axis.replaceChildren(...tracked.axes.map((name, k) => html("option", { value: k }, name)));
    axis.value = String(axisShown);
    innovations.show(innovationsOf(now));
    picture.redraw();
  });
  store.follow(["tracked", "trackShown"], () => picture.fit());
}

function shownTrack({ tracked, trackShown }) {
  return tracked?.tracks[trackShown] ?? null;
}

function layerOf(now) {
  const track = shownTrack(now);
  if (!track) return {};
  const coasted = track.plots.map((point) => point.some((value) => value === null));
  const lines = Object.entries(track.trackers).map(([name, { filtered }], index) => ({
    name, index, points: filtered, coasted,
  }));
  return { time: track.time, truth: track.truth ?? [], plots: track.plots, lines };
}

function innovationsOf(now) {
  const { time, trackers } = shownTrack(now);
  return {
    name: "Innovations, plot minus prediction",
    x: { label: "time (s)" },
    y: { label: "innovation (m)" },
    limits: [{ y: 0, label: "" }],
    series: Object.entries(trackers).map(([name, { innovation }], index) => ({
      name,
      index,
      x: time,
      y: innovation.map((row) => row[now.axisShown]),
    })),
  };
}

function factsOf({ name, plots, tracks, sigma }) {
  const words = [name, `${shown(plots, 7)} plots`, tracks.length > 1 ? `${tracks.length} tracks` : "1 track"];
  if (sigma !== null && sigma !== undefined) words.push(`σ ${[sigma].flat().map((value) => shown(value, 4)).join(", ")} m`);
  return words.join(" · ");
}

function comparisonTable({ comparison: { columns, rows } }) {
  return html(
    "table",
    { class: "result-table" },
    html("caption", { class: "unseen" }, "Trackers on the recording"),
    html(
      "thead",
      {},
      html(
        "tr",
        {},
        html("th", { scope: "col" }, "Tracker"),
        ...columns.map(([, text, unit]) => html("th", { scope: "col" }, text, html("small", {}, unit ?? ""))),
      ),
    ),
    html(
      "tbody",
      {},
      rows.map((row, index) =>
        html(
          "tr",
          {},
          html("th", { scope: "row" }, html("div", { class: "named" }, swatch(index), row.name)),
          ...columns.map(([key]) => cellOf(row, key)),
        ),
      ),
    ),
  );
}

function cellOf(row, key) {
  const value = row[key];
  if (typeof value !== "number") return html("td", {}, value ?? "–");
  const error = row[`${key}_se`];
  return html(
    "td",
    { title: String(value), "data-key": key, "data-value": value },
    shown(value, 4),
    Number.isFinite(error) ? html("span", { class: "se" }, ` ± ${shown(error, 2)}`) : null,
  );
}
