/* The pane of results: the table and four pictures; or two designs side by side; or one run. */

import { choice, html } from "./elements.js";
import { makeChart } from "./chart.js";
import { errorsOf, finite, first, linesOf, namesOf, trajectoriesOf } from "./curves.js";
import { figure } from "./figure.js";
import { keepText } from "./files.js";
import { keepFocus } from "./focus.js";
import { isBusy } from "./jobbar.js";
import { numberEntries, scriptEntries } from "./keep.js";
import { menu } from "./menu.js";
import * as pair from "./pair.js";
import { resultTable } from "./resulttable.js";
import { makeTrackPicture } from "./trackpicture.js";
import * as walk from "./walk.js";

export const title = "Results";
const TABS = [
  ["all", "All trackers"],
  ["pair", "Side by side"],
  ["walk", "One run"],
];
const QUANTITIES = [
  ["predicted", "predicted", "Distance of the prediction to the truth"],
  ["filtered", "filtered", "Distance of the estimate to the truth"],
];
const BANDS = [
  ["se", "±2 SE", "Two standard errors to each side of the RMSE"],
  ["spread", "10–90%", "Where eight of ten runs are (of predictions)"],
];
const GAINS = [
  ["alpha", "α"],
  ["beta", "β"],
  ["gamma", "γ"],
];

export function mount(element, app) {
  const { store } = app;
  const tabs = choice("Results as", (resultsTab) => store.set({ resultsTab }));
  const parts = Object.fromEntries(
    TABS.map(([key, text]) => [
      key,
      html("div", { class: `results-${key}`, "aria-label": text, role: "group" }),
    ]),
  );
  const empty = html(
    "div",
    { class: "nothing" },
    html(
      "p",
      {},
      "No results yet. Choose trackers on the left and press Run; results come in while it runs.",
    ),
  );
  const about = html("span", { class: "muted" });

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      tabs.element,
      about,
      html("span", { class: "space" }),
      menu("Keep the results", "Keep", () => keepers(app)),
    ),
    empty,
    ...Object.values(parts),
  );
  mountAll(parts.all, app);
  pair.mount(parts.pair, app);
  walk.mount(parts.walk, app);

  // Progress comes without results; the last ones stay until there are new ones.
  store.follow(["job"], ({ job }) => {
    if (job?.kind === "run" && job.results) store.set({ results: job.results });
  });
  store.follow(["resultsTab", "results"], ({ resultsTab, results }) => {
    tabs.show(TABS, resultsTab);
    empty.hidden = Boolean(results) || resultsTab === "walk";
    for (const [key, part] of Object.entries(parts)) {
      part.hidden = key !== resultsTab || (!results && key !== "walk");
    }
  });
  store.follow(["results", "ranWith", "state", "scenario", "jobs"], (now) => {
    about.textContent = now.results ? aboutOf(now) : "";
  });
}

/** What the results are of, and what has been changed since. */
function aboutOf({ results, ranWith, state, scenario, jobs }) {
  const name = `${results.scenario}${ranWith?.changed ? " (changed)" : ""}`;
  const about = `${name}, ${results.runs} runs, seed ${results.seed}`;
  if (!ranWith || !state || !scenario || isBusy(jobs.run)) return about;
  const since = [
    ...(state.text === ranWith.rules ? [] : ["rules"]),
    ...(scenario.text === ranWith.scenario ? [] : ["scenario"]),
  ];
  return since.length ? `${about}; ${since.join(" and ")} changed since` : about;
}

function mountAll(element, app) {
  const { store } = app;
  const table = html("div", { class: "scroll" });
  const notes = html("ul", { class: "notes", tabindex: 0, "aria-label": "Notes" });
  const quantity = choice("Quantity", (value) => store.set({ quantity: value }));
  const band = choice("Band", (value) => store.set({ band: value }));
  const gain = choice("Gain", (value) => store.set({ gain: value }));
  const lines = () => linesOf(store.now);
  const errors = makeChart();
  const distribution = makeChart();
  const gains = makeChart();
  const tracks = makeTrackPicture("Trajectories of the first run", () => trajectoriesOf(store.now));

  element.append(
    table,
    notes,
    html(
      "div",
      { class: "pictures" },
      figure(app, "Error over time", "errors", errors, lines, [quantity.element, band.element]),
      figure(app, "Trajectories", "trajectories", tracks, lines, [
        html("span", { class: "muted" }, "run 0; × plots, □ coasted"),
      ]),
      figure(app, "Error distribution", "distribution", distribution, lines),
      figure(app, "Gains over time", "gains", gains, lines, [
        html("span", { class: "muted" }, "run 0"),
        gain.element,
      ]),
    ),
  );

  function sortBy(key) {
    const { sorting } = store.now;
    store.set({ sorting: { key, down: sorting.key === key ? !sorting.down : false } });
  }

  function drawTable({ results, hidden, sorting }) {
    if (!results) return;
    notes.hidden = !results.notes?.length;
    notes.replaceChildren(...(results.notes ?? []).map((text) => html("li", {}, text)));
    keepFocus(table, () =>
      table.replaceChildren(resultTable(results, hidden, app.toggleLine, sorting, sortBy)),
    );
  }

  function draw(now) {
    const { results, quantity: what, band: around, gain: which } = now;
    quantity.show(QUANTITIES, what);
    band.show(BANDS, around);
    if (!results) return;
    const known = GAINS.filter(([key]) =>
      Object.values(results.sample.trackers).some((each) => each[key]?.some((row) => finite(first(row)))),
    );
    const shownGain = known.some(([key]) => key === which) ? which : "alpha";
    gain.show(known, shownGain);
    errors.show(errorsOf(now));
    distribution.show(distributionOf(now));
    gains.show(gainsOf(now, shownGain));
    tracks.redraw();
  }

  store.follow(["results", "hidden", "sorting"], drawTable);
  store.follow(["results", "hidden", "quantity", "band", "gain", "scheme", "resultsTab", "view"], draw);
  let scenario = null;
  store.follow(["results"], ({ results }) => {
    if (results && scenario !== results.scenario) tracks.fit();
    scenario = results?.scenario;
  });
}

function distributionOf({ results, hidden }) {
  const { edges, counts } = results.distribution;
  const series = namesOf(results).flatMap((name, index) => {
    const found = counts[name];
    if (!found || hidden.includes(name)) return [];
    const all = found.reduce((sum, count) => sum + count, 0) || 1;
    return [{ name, index, kind: "steps", x: edges, y: found.map((count) => (100 * count) / all) }];
  });
  return {
    name: "Distribution of the distance of prediction; the last bar has all above",
    x: { label: "distance of prediction (m), the last bar has all above" },
    y: { label: "share (%)", low: 0 },
    series,
  };
}

function gainsOf({ results, hidden }, gain) {
  const { time, trackers } = results.sample;
  const series = namesOf(results).flatMap((name, index) =>
    hidden.includes(name) || !trackers[name]
      ? []
      : [{ name, index, x: time, y: trackers[name][gain].map(first) }],
  );
  const sign = GAINS.find(([key]) => key === gain)[1];
  return {
    name: `Gain ${sign} over time in the first run, first axis`,
    x: { label: "time (s)" },
    y: { label: `gain ${sign}` },
    series,
  };
}

/** What can be kept of the results. */
function keepers(app) {
  const { results, asked } = app.store.now;
  if (!results) return [{ heading: "Run first" }];
  const report = { text: "Report (HTML)", run: () => keepText(app, "report", {}, "Report") };
  return [
    ...numberEntries(`${results.scenario}-seed${results.seed}`, results, results.trackers),
    ...(app.can("report") ? [report] : []),
    ...scriptEntries(app, "run", asked ?? {}),
  ];
}
