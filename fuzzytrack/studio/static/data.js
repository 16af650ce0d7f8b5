/* The pane of own data: tracks of a recording, innovations, and how the trackers compare on it. */

import { makeChart } from "./chart.js";
import { argumentsOf, inFields } from "./columns.js";
import { html, select } from "./elements.js";
import { action, group } from "./fields.js";
import { figure } from "./figure.js";
import { isBusy, jobBar } from "./jobbar.js";
import { numberEntries, scriptEntries } from "./keep.js";
import { menu } from "./menu.js";
import { even, shown, withPlaces } from "./numbers.js";
import { chosenTrackers, trackerList } from "./pick.js";
import { recordingForm, withRemedies } from "./recording.js";
import { lineButton } from "./resulttable.js";
import { makeTrackPicture } from "./trackpicture.js";

export const title = "Own data";

// What the columns of the comparison say.
const HELP = {
  predicted: "Root mean square distance of the predictions to the truth",
  filtered: "Root mean square distance of the estimates to the truth",
  rms: "Root mean square of the innovations: plot minus prediction, the noise of the plots included",
  change: "Error of prediction against that of the first tracker, with its 95 % interval; of the innovations where there is no truth",
  log_likelihood: "Mean logarithm of the density that the tracker predicted at a plot; more is better. Trackers without a covariance have none",
  outside: "Plots farther than three standard deviations from their prediction, by the tracker's own covariance",
  whiteness: "Correlation of successive innovations; 0 for a filter that fits the target",
};

const MARKS =
  "Best: the least error of prediction. Worse: worse than the plots themselves; the plot before predicts better";
// Decimal places of columns whose values are of one size.
const PLACES = { change: 1, outside: 1, log_likelihood: 2, whiteness: 3 };

export function mount(element, app) {
  const { store, socket, say } = app;
  const recording = recordingForm(app, run);
  const picks = trackerList(app, "recordedTrackers");
  const compare = action("Track and compare", run, { class: "primary" });
  const { element: progress, cancel, words } = jobBar(app, "track", "Progress of the recording", compare);
  const facts = html("p", { class: "muted what" });
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
      figure(app, "Track", "track", picture, lines, [which], nameOf),
      figure(app, "Innovations", "innovations", innovations, lines, [axis], nameOf),
    ),
  );
  const hint = html("p");
  const empty = html("div", { class: "nothing" }, hint);
  const work = html(
    "div",
    { class: "work", hidden: true },
    html("p", { class: "muted", role: "status" }),
    html("progress", { "aria-label": "The recording is read" }),
  );
  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      html("span", { class: "space" }),
      menu("Keep the comparison", "Keep", keepers),
      compare,
      cancel,
    ),
    html(
      "div",
      { class: "beside" },
      html("div", { class: "tall" }, work, progress, empty, body),
      html("div", { class: "side" }, recording.element, group("Trackers", picks.element)),
    ),
  );
  // Anywhere on the page: the browser would leave it for a file that is dropped beside the field.
  for (const kind of ["dragover", "dragleave", "drop"]) document.addEventListener(kind, recording.dragged);

  function keepers() {
    const { tracked, recording: name, recordedTrackers } = store.now;
    if (!tracked) return [{ heading: "Track and compare first" }];
    const args = { name, trackers: chosenTrackers(recordedTrackers), ...argumentsOf(store.now) };
    return [
      ...numberEntries(tracked.name, tracked, tracked.comparison.rows),
      ...scriptEntries(app, "track", args),
    ];
  }

  async function run() {
    const { recording: name, recordedTrackers } = store.now;
    const trackers = chosenTrackers(recordedTrackers);
    if (!name) return say("There is no recording: drop a CSV file, or choose one in the folder.", "error");
    if (!trackers.length) return say("No tracker is chosen: check one in the list, or add one.", "error");
    try {
      await socket.send("track", { name, trackers, ...argumentsOf(store.now) });
      say("");
    } catch (error) {
      say(inFields(error.message), "error");
    }
  }

  store.follow(["job"], ({ job, recording: name, tracked: before }) => {
    // That of another recording was asked for before this one was chosen.
    if (job?.kind !== "track" || job.results?.name !== name) return;
    const kept = name === before?.name;
    store.set({ tracked: job.results, ...(kept ? {} : { trackShown: 0, axisShown: 0 }) });
  });

  store.follow(["tracked", "trackShown", "axisShown", "hidden", "scheme", "view"], (now) => {
    const { tracked, trackShown, axisShown, hidden } = now;
    body.hidden = !tracked;
    empty.hidden = Boolean(tracked);
    if (!tracked) return;
    facts.textContent = factsOf(tracked);
    notes.hidden = !tracked.notes.length;
    notes.replaceChildren(...tracked.notes.map((text) => html("li", {}, ...withRemedies(text, recording.put))));
    showTable(tracked, hidden);
    which.replaceChildren(
      ...tracked.drawn.map(({ id }, k) => html("option", { value: k }, id ? `track ${id}` : "the track")),
    );
    which.value = String(trackShown);
    axis.replaceChildren(...tracked.found.axes.map((name, k) => html("option", { value: k }, name)));
    axis.value = String(axisShown);
    innovations.show(innovationsOf(now));
    picture.redraw();
  });
  store.follow(["tracked", "trackShown"], () => picture.fit());
  // What became of the tracks of another file, or of what was said of this one before.
  store.follow(["working"], ({ working }) => {
    if (working) words.textContent = "";
  });
  store.follow(["working", "recording", "described", "jobs"], (now) => {
    work.hidden = !now.working;
    work.firstChild.textContent = `${now.recording} is being read.`;
    hint.textContent = hintOf(now);
  });

  function showTable(tracked, hidden) {
    const held = [...table.querySelectorAll("button")].indexOf(document.activeElement);
    table.replaceChildren(comparisonTable(tracked, hidden, app.toggleLine));
    // The row was drawn anew: the focus goes back to where it was.
    if (held >= 0) table.querySelectorAll("button")[held]?.focus();
  }
}

function hintOf({ working, recording, described, jobs }) {
  if (working || isBusy(jobs.track)) return "";
  if (described?.problem) return `${recording} cannot be read yet: the message below its name says why.`;
  if (recording) return `Track and compare: all trackers that are checked follow the tracks of ${recording}.`;
  return "Drop a CSV file with columns of time and position, or choose one in the folder. All trackers that are checked follow its tracks and are compared.";
}

function nameOf({ tracked }) {
  return tracked?.name.replace(/\.csv$/i, "");
}

function shownTrack({ tracked, trackShown }) {
  return tracked?.drawn[trackShown] ?? null;
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

function factsOf({ name, plots, tracks, noise, comparison, drawn }) {
  const words = [name, `${shown(plots, 7)} plots`, tracks === 1 ? "1 track" : `${tracks} tracks`];
  const seen = drawn.reduce((sum, { time }) => sum + time.length, 0);
  if (drawn.length < tracks || seen < plots)
    words.push(`the first ${drawn.length > 1 ? `${drawn.length} tracks, ` : ""}${seen} plots drawn`);
  if (noise.length) words.push(noiseInWords(noise));
  words.push(`${shown(comparison.scored, 7)} innovations compared`);
  if (Number.isFinite(comparison.measured_rmse))
    words.push(`RMSE of the plots ${shown(comparison.measured_rmse, 4)} m`);
  return words.join(" · ");
}

/** Standard deviations of the plots; those that are estimated with ≈. */
function noiseInWords(noise) {
  const each = noise.map(({ sigma, error, unit }) => {
    if (typeof sigma === "string") return `column ${sigma}`;
    return sigma === null ? "not known" : `${error ? "≈ " : ""}${shown(sigma, 3)} ${unit}`;
  });
  return `σ ${[...new Set(each)].join(", ")}`;
}

function comparisonTable({ comparison }, hidden, toggle) {
  const { columns, rows } = comparison;
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
        ...columns.map(([key, text, unit]) =>
          html("th", { scope: "col", title: HELP[key] }, text, html("small", {}, unit)),
        ),
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
              row.mark ? html("span", { class: "mark", title: MARKS }, row.mark) : null,
            ),
          ),
          ...columns.map(([key]) => cellOf(row, key)),
        ),
      ),
    ),
    html("tfoot", {}, expectedRow(comparison)),
  );
}

/** What a filter would have that fits the targets, where that is known. */
function expectedRow({ columns, expected_outside: outside, expected_correlation: correlation }) {
  const known = {
    outside: `${withPlaces(outside, PLACES.outside)}`,
    whiteness: `± ${shown(correlation, 2)}`,
  };
  return html(
    "tr",
    {},
    html("th", { scope: "row" }, "expected of a filter that fits"),
    ...columns.map(([key]) => html("td", {}, known[key] ?? "")),
  );
}

function cellOf(row, key) {
  const value = row[key];
  if (typeof value !== "number") return html("td", {}, "–");
  const [low, high] = [row[`${key}_low`], row[`${key}_high`]];
  const interval = Number.isFinite(low) ? `, 95 % interval ${low} to ${high}` : "";
  return html(
    "td",
    { title: `${value}${interval}`, "data-key": key, "data-value": value },
    PLACES[key] === undefined ? even(value, 4) : withPlaces(value, PLACES[key]),
    Number.isFinite(low) ? html("small", { class: "se" }, `${shown(low, 3)} to ${shown(high, 3)}`) : null,
  );
}
