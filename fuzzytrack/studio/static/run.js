/* The pane that starts a Monte Carlo experiment: its trackers, runs and seed. */

import { html } from "./elements.js";
import { action, group, numberField } from "./fields.js";
import { isBusy, jobBar } from "./jobbar.js";
import { chosenTrackers, trackerList } from "./pick.js";

export const title = "Run";

export function mount(element, app) {
  const { store, socket, say } = app;
  const picks = trackerList(app, "trackers");
  const runs = numberField("Runs", "", (value) => store.set({ wantedRuns: value }), {
    least: 1,
    whole: true,
  });
  const seed = numberField("Seed", "", (value) => store.set({ seed: value }), {
    least: 0,
    whole: true,
    title: "The same seed gives the same plots, here and at the command line",
  });
  const start = action("Run", run, { class: "primary", title: "Run (Ctrl Enter)" });
  const { element: progress, cancel, words } = jobBar(app, "run", "Progress of the runs", start);
  const what = html("p", { class: "muted" });

  element.append(
    html("header", {}, html("h2", {}, title), html("span", { class: "space" }), start, cancel),
    html(
      "div",
      { class: "side" },
      progress,
      group("Scenario", what),
      group("Experiment", html("div", { class: "form-grid" }, runs.element, seed.element)),
      group("Trackers", picks.element),
    ),
  );
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    run();
  });

  async function run() {
    const { wantedRuns, seed: wanted, jobs, state, scenario } = store.now;
    if (isBusy(jobs.run)) return;
    const texts = chosenTrackers(store.now.trackers);
    if (!texts.length) {
      say("No tracker is chosen: check one in the list, or add one.", "error");
      return;
    }
    store.set({ view: "run" });
    words.textContent = "Starting…";
    try {
      await socket.send("run", { trackers: texts, runs: wantedRuns, seed: wanted });
      store.set({
        asked: { trackers: texts, runs: wantedRuns, seed: wanted },
        ranWith: { rules: state.text, scenario: scenario.text, changed: !scenario.saved },
      });
    } catch (error) {
      words.textContent = "";
      say(error.message, "error");
    }
  }

  store.follow(["wantedRuns", "seed"], ({ wantedRuns, seed: wanted }) => {
    runs.show(wantedRuns);
    seed.show(wanted);
  });
  store.follow(["scenario"], ({ scenario }) => {
    if (!scenario) return;
    const { scans, axes } = scenario.scenario;
    what.textContent = `${scenario.name}${scenario.saved ? "" : " (changed)"}: ${scans} scans, ${axes} ${axes > 1 ? "axes" : "axis"}`;
  });
  // The first time, the trackers of the scenario beside the rule base that is edited.
  store.follow(["scenario"], ({ trackers, scenario }) => {
    if (trackers.length || !scenario) return;
    store.set({
      trackers: ["editor", ...(scenario.scenario.trackers ?? [])].map((text) => ({ text, on: true })),
    });
  });
}
