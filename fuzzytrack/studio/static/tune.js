/* The pane that tunes the numbers of a tracker, on the recording or on the scenario. */

import { argumentsOf, inFields } from "./columns.js";
import { choice, html } from "./elements.js";
import { action, group, numberField, textField } from "./fields.js";
import { jobBar } from "./jobbar.js";
import { numberEntries, scriptEntries } from "./keep.js";
import { menu } from "./menu.js";
import { even, shown, withPlaces } from "./numbers.js";
import { download } from "./pictures.js";

export const title = "Tune";

export function mount(element, app) {
  const { store, socket, say } = app;
  const on = choice("Tune on", (tuneOn) => store.set({ tuneOn }));
  const tracker = textField("Tracker", "editor, a rule base, or kalman-cv:sigma_v=2", (text) =>
    put({ tracker: text }),
  );
  const free = textField(
    "Numbers to tune",
    "all; or e.g. outputs, E.ns",
    (text) => put({ free: text }),
    "Of a rule base: outputs, sets, normalization, the name of a variable (stiffness), a set (E.ns) or a setting; of other trackers: their parameters",
  );
  const whole = { least: 1, whole: true };
  const trials = numberField("Trials", "", (value) => put({ trials: value }), {
    ...whole,
    title: "Sets of numbers that are tried, in each fold",
  });
  const folds = numberField("Folds", "", (value) => put({ folds: value }), {
    least: 2,
    whole: true,
    title: "Parts of the data; each is judged with numbers that were tuned on the others",
  });
  const what = html("p", { class: "muted" });
  const runs = numberField("Runs", "", (value) => put({ runs: value }), {
    ...whole,
    title: "Runs of the scenario that are simulated",
  });
  const start = action("Tune", run, { class: "primary" });
  const { element: progress, cancel } = jobBar(app, "tune", "Progress of tuning", start);
  const found = html("div", { class: "tuned" });

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      html("span", { class: "space" }),
      menu("Keep the tuning", "Keep", keepers),
      start,
      cancel,
    ),
    html(
      "div",
      { class: "side" },
      progress,
      found,
      group(
        "What",
        html("div", { class: "field" }, html("span", { class: "label" }, "On"), on.element, what),
        tracker.element,
        free.element,
        html("div", { class: "form-grid" }, trials.element, folds.element, runs.element),
      ),
    ),
  );

  function put(change) {
    store.set({ tuning: { ...store.now.tuning, ...change } });
  }

  /** What the command is told. */
  function asked() {
    const { tuning, tuneOn, recording, seed } = store.now;
    const { free: numbers, runs: simulated, ...rest } = tuning;
    const recorded = tuneOn === "recording";
    const place = recorded ? { on: recording, ...argumentsOf(store.now) } : { runs: simulated };
    return { ...place, ...rest, free: numbers || null, seed };
  }

  async function run() {
    const { tuneOn, recording } = store.now;
    if (tuneOn === "recording" && !recording) {
      say("There is no recording to tune on: drop or choose one, or tune on the scenario.", "error");
      return;
    }
    try {
      await socket.send("tune", asked());
    } catch (error) {
      say(inFields(error.message), "error");
    }
  }

  function keepers() {
    const { tuned } = store.now;
    const numbers = tuned ? numberEntries("tuning", tuned, tuned.errors) : [];
    const text = tuned?.text
      ? [{ text: "Rule base (YAML)", run: () => download("tuned.yaml", tuned.text) }]
      : [];
    return [...numbers, ...text, ...scriptEntries(app, "tune", asked())];
  }

  function choose(text) {
    const key = store.now.tuneOn === "recording" ? "recordedTrackers" : "trackers";
    const others = store.now[key].filter((each) => each.text !== text);
    store.set({ [key]: [...others, { text, on: true }], view: key === "trackers" ? "run" : "data" });
  }

  async function openInEditor(text) {
    if (await app.edit("set_text", { text }))
      say("The tuned rule base is in the editor; undo takes it back.");
    app.show({ tab: "table" });
  }

  store.follow(["tuneOn", "recording", "scenario"], ({ tuneOn, recording, scenario }) => {
    on.show(
      [
        ["scenario", "the scenario"],
        ["recording", "the recording"],
      ],
      tuneOn,
    );
    runs.element.hidden = tuneOn === "recording";
    const changed = scenario && !scenario.saved ? " (changed)" : "";
    what.textContent = tuneOn === "recording" ? (recording ?? "none is chosen") : `${scenario?.name}${changed}`;
  });
  store.follow(["tuning"], ({ tuning }) => {
    tracker.show(tuning.tracker);
    free.show(tuning.free);
    trials.show(tuning.trials);
    folds.show(tuning.folds);
    runs.show(tuning.runs);
  });
  store.follow(["job"], ({ job }) => {
    if (job?.kind === "tune" && job.results) store.set({ tuned: job.results });
  });
  store.follow(["tuned"], ({ tuned }) => {
    found.hidden = !tuned;
    if (!tuned) return;
    const { verdict, text, specification } = tuned;
    const use = text
      ? html(
          "button",
          { type: "button", class: "primary", onclick: () => openInEditor(text) },
          "Open in the editor",
        )
      : html(
          "button",
          { type: "button", class: "primary", onclick: () => choose(specification) },
          "Add to the trackers",
        );
    found.replaceChildren(
      html("p", {}, `${verdict[0].toUpperCase()}${verdict.slice(1)}.`.replace(/-(?=\d)/g, "−")),
      ...tablesOf(tuned),
      html("div", { class: "actions" }, use),
      ...tuned.notes.map((note) => html("p", { class: "muted" }, note)),
    );
  });
}

/** The errors on what it was not tuned on, and the numbers, before and after. */
function tablesOf({ errors, objective, units, numbers, start }) {
  // From each to the tuned one: relative of an RMS error, a difference of likelihoods.
  const relative = objective.startsWith("RMS");
  const inWords = (change) => {
    if (change === null) return "";
    const sign = change > 0 ? "+" : "";
    return sign + (relative ? `${withPlaces(100 * change, 1)} %` : withPlaces(change, 3));
  };
  return [
    html(
      "table",
      { class: "result-table" },
      html(
        "caption",
        {},
        `${objective}${relative ? " (m)" : ""}, on ${units} that it was not tuned on, and the change to the tuned one`,
      ),
      html(
        "tbody",
        {},
        errors.map(({ name, held_out: value, change, change_low: low, change_high: high }) =>
          html(
            "tr",
            {},
            html("th", { scope: "row" }, name),
            html("td", { "data-value": value }, even(value, 4)),
            html(
              "td",
              { class: "se", title: `95 % interval ${inWords(low)} to ${inWords(high)}` },
              inWords(change),
            ),
          ),
        ),
      ),
    ),
    html(
      "details",
      {},
      html("summary", {}, `${Object.keys(numbers).length} numbers`),
      html(
        "table",
        { class: "result-table" },
        html(
          "tbody",
          {},
          Object.entries(numbers).map(([name, value]) =>
            html(
              "tr",
              {},
              html("th", { scope: "row" }, name),
              html("td", { class: "se" }, shown(start[name], 4)),
              html("td", {}, shown(value, 4)),
            ),
          ),
        ),
      ),
    ),
  ];
}
