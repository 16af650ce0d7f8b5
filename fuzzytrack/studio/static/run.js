/* The pane that starts a Monte Carlo experiment: its trackers, runs and seed, progress and cancel. */

import { html } from "./elements.js";
import { action, group, numberField } from "./fields.js";
import { chosenTrackers, trackerList } from "./pick.js";

export const title = "Run";

export function mount(element, app) {
  const { store, socket, say } = app;
  const picks = trackerList(app);
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
  const cancel = html("button", { type: "button", onclick: stop }, "Cancel");
  const bar = html("progress", { max: 1, "aria-label": "Progress of the runs" });
  const words = html("p", { class: "muted", role: "status" });
  const what = html("p", { class: "muted" });

  element.append(
    html("header", {}, html("h2", {}, title), html("span", { class: "space" }), start, cancel),
    html(
      "div",
      { class: "side" },
      html("div", { class: "progress" }, bar, words),
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
    const { wantedRuns, seed: wanted, job } = store.now;
    if (job?.state === "running") return;
    const texts = chosenTrackers(store.now);
    if (!texts.length) {
      say("No tracker is chosen: check one in the list, or add one.", "error");
      return;
    }
    store.set({ view: "run" });
    words.textContent = "Starting…";
    try {
      await socket.send("run", { trackers: texts, runs: wantedRuns, seed: wanted });
      store.set({ asked: { trackers: texts, runs: wantedRuns, seed: wanted } });
    } catch (error) {
      words.textContent = "";
      say(error.message, "error");
    }
  }

  async function stop() {
    const { job } = store.now;
    try {
      const answer = await socket.send("cancel", { job: job.id });
      store.set({ job: answer.job });
    } catch (error) {
      say(error.message, "error");
    }
  }

  store.follow(["wantedRuns", "seed"], ({ wantedRuns, seed: wanted }) => {
    runs.show(wantedRuns);
    seed.show(wanted);
  });
  store.follow(["job"], ({ job }) => {
    const own = job?.kind === "run";
    const running = own && job.state === "running";
    start.hidden = running;
    cancel.hidden = !running;
    bar.hidden = !running;
    if (running && job.done) bar.value = job.done / job.of;
    else bar.removeAttribute("value");
    words.textContent = own ? told(job) : "";
    words.classList.toggle("failed", own && job.state === "failed");
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

/** A job in words. */
export function told({ kind, done, of, seconds, seconds_left: left, state, error }) {
  const count = kind === "run" ? `${done} of ${of} runs` : `${Math.round((100 * done) / of)} %`;
  if (state === "running") return `${count}${left === null ? "" : `, ${duration(left)} left`}`;
  if (state === "cancelled") return `Canceled after ${count}.`;
  if (state === "failed") return `Failed: ${error}`;
  return `${kind === "run" ? `${of} runs` : "Done"} in ${duration(seconds)}.`;
}

function duration(seconds) {
  if (seconds < 9.95) return `${seconds.toFixed(1)} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return `${Math.round(seconds / 60)} min`;
}
