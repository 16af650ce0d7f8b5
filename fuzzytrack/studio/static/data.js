/* The pane of own data: tracks of a recording, innovations, and how the trackers compare on it. */

import { makeChart } from "./chart.js";
import { html, select } from "./elements.js";
import { action, group } from "./fields.js";
import { figure } from "./figure.js";
import { numberEntries, scriptEntries } from "./keep.js";
import { menu } from "./menu.js";
import { even, shown } from "./numbers.js";
import { chosenTrackers, trackerList } from "./pick.js";
import { columnsOf, recordingForm } from "./recording.js";
import { lineButton } from "./resulttable.js";
import { makeTrackPicture } from "./trackpicture.js";

export const title = "Own data";
const AXES = ["x", "y", "z"];

export function mount(element, app) {
  const { store, socket, say } = app;
  const recording = recordingForm(app, run);
  const picks = trackerList(app);
  const compare = action("Track and compare", run, { class: "primary" });
  const facts = html("p", { class: "muted" });
  const notes = html("ul", { class: "notes", tabindex: 0, "aria-label": "Notes" });
  const table = html("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Comparison" });
  const which = select("Track", [], "", (value) => store.set({ trackShown: Number(value) }));
  const axis = select("Axis", [], "", (value) => store.set({ axisShown: Number(value) }));
  const lines = () => linesOf(store.now).map(({ name, index }) => [name, index]);
  const innovations = makeChart();
  const picture = makeTrackPicture("Recorded track", () => layerOf(store.now));
  const body = html(
    "div",
    { class: "filled" },
    facts,
    notes,
    table,
    html(
      "div",
      { class: "pictures" },
      figure(app, "Track", "data-track", picture, lines, [which]),
      figure(app, "Innovations", "data-innovations", innovations, lines, [axis]),
    ),
  );
  const empty = html(
    "div",
    { class: "nothing" },
    html(
      "p",
      {},
      "Drop a CSV file with columns of time and position, or choose one in the folder. All trackers that are checked follow its tracks and are compared.",
    ),
  );

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      html("span", { class: "space" }),
      menu("Keep the comparison", "Keep", keepers),
      compare,
    ),
    html(
      "div",
      { class: "beside" },
      html("div", { class: "tall" }, empty, body),
      html("div", { class: "side" }, recording.element, group("Trackers", picks.element)),
    ),
  );
  for (const kind of ["dragover", "dragleave", "drop"]) element.addEventListener(kind, recording.dragged);

  function keepers() {
    const { tracked, recording: name } = store.now;
    if (!tracked) return [{ heading: "Track and compare first" }];
    const args = { name, trackers: chosenTrackers(store.now), ...columnsOf(store.now) };
    return [
      ...numberEntries(tracked.name, tracked, tracked.comparison.rows),
      ...scriptEntries(app, "track", args),
    ];
  }

  async function run() {
    const { recording: name } = store.now;
    const trackers = chosenTrackers(store.now);
    if (!name) return say("There is no recording: drop a CSV file, or choose one in the folder.", "error");
    if (!trackers.length) return say("No tracker is chosen: check one in the list, or add one.", "error");
    try {
      const tracked = await socket.send("track", { name, trackers, ...columnsOf(store.now) });
      store.set({ tracked, trackShown: 0, axisShown: 0 });
      say(`${name}: ${tracked.plots} plots are tracked.`);
    } catch (error) {
      say(error.message, "error");
    }
  }

  store.follow(["tracked", "trackShown", "axisShown", "hidden", "scheme", "view"], (now) => {
    const { tracked, trackShown, axisShown, hidden } = now;
    body.hidden = !tracked;
    empty.hidden = Boolean(tracked);
    if (!tracked) return;
    facts.textContent = factsOf(tracked);
    notes.hidden = !tracked.notes.length;
    notes.replaceChildren(...tracked.notes.map((text) => html("li", {}, text)));
    showTable(tracked, hidden);
    which.replaceChildren(
      ...tracked.tracks.map(({ id }, k) => html("option", { value: k }, id ? `track ${id}` : "the track")),
    );
    which.value = String(trackShown);
    axis.replaceChildren(...AXES.slice(0, tracked.axes).map((name, k) => html("option", { value: k }, name)));
    axis.value = String(axisShown);
    innovations.show(innovationsOf(now));
    picture.redraw();
  });
  store.follow(["tracked", "trackShown"], () => picture.fit());

  function showTable(tracked, hidden) {
    const held = [...table.querySelectorAll("button")].indexOf(document.activeElement);
    table.replaceChildren(comparisonTable(tracked, hidden, app.toggleLine));
    // The row was drawn anew: the focus goes back to where it was.
    if (held >= 0) table.querySelectorAll("button")[held]?.focus();
  }
}

function shownTrack({ tracked, trackShown }) {
  return tracked?.tracks[trackShown] ?? null;
}

/** What the trackers that are not hidden made of the track: {name, index, filtered, innovation}. */
function linesOf(now) {
  return Object.entries(shownTrack(now).trackers)
    .map(([name, found], index) => ({ name, index, ...found }))
    .filter(({ name }) => !now.hidden.includes(name));
}

function layerOf(now) {
  const track = shownTrack(now);
  if (!track) return {};
  const coasted = track.plots.map((point) => point.some((value) => value === null));
  const lines = linesOf(now).map(({ name, index, filtered }) => ({ name, index, points: filtered, coasted }));
  return { time: track.time, truth: track.truth ?? [], plots: track.plots, lines };
}

function innovationsOf(now) {
  const { time } = shownTrack(now);
  return {
    name: "Innovations, plot minus prediction",
    x: { label: "time (s)" },
    y: { label: "innovation (m)" },
    limits: [{ y: 0, label: "" }],
    series: linesOf(now).map(({ name, index, innovation }) => ({
      name,
      index,
      x: time,
      y: innovation.map((row) => row[now.axisShown]),
    })),
  };
}

function factsOf({ name, plots, tracks, sigma, comparison, shown: drawn }) {
  const words = [name, `${shown(plots, 7)} plots`, tracks.length > 1 ? `${drawn} tracks drawn` : "1 track"];
  if (sigma)
    words.push(
      `σ ${[sigma]
        .flat()
        .map((value) => shown(value, 3))
        .join(", ")} m`,
    );
  words.push(`${shown(comparison.scored, 7)} innovations compared`);
  if (Number.isFinite(comparison.measured_rmse))
    words.push(`RMSE of the plots ${shown(comparison.measured_rmse, 4)} m`);
  return words.join(" · ");
}

function comparisonTable({ comparison: { columns, rows } }, hidden, toggle) {
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
        ...columns.map(([, text, unit]) => html("th", { scope: "col" }, text, html("small", {}, unit))),
      ),
    ),
    html(
      "tbody",
      {},
      rows.map((row, index) =>
        html(
          "tr",
          { class: `${row.mark} ${hidden.includes(row.name) ? "off" : ""}`.trim() },
          html(
            "th",
            { scope: "row" },
            html(
              "div",
              {},
              lineButton(row.name, index, hidden.includes(row.name), toggle),
              row.mark ? html("span", { class: "mark" }, row.mark) : null,
            ),
          ),
          ...columns.map(([key]) => cellOf(row, key)),
        ),
      ),
    ),
  );
}

function cellOf(row, key) {
  const value = row[key];
  if (typeof value !== "number") return html("td", {}, "–");
  const [low, high] = [row[`${key}_low`], row[`${key}_high`]];
  return html(
    "td",
    { title: String(value), "data-key": key, "data-value": value },
    even(value, 4),
    Number.isFinite(low) ? html("span", { class: "se" }, ` [${shown(low, 3)}, ${shown(high, 3)}]`) : null,
  );
}
