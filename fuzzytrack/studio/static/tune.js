/* The pane that tunes the numbers of a tracker, on the recording or on the scenario. */

import { choice, html } from "./elements.js";
import { action, group, numberField } from "./fields.js";
import { shown } from "./numbers.js";
import { told } from "./run.js";

export const title = "Tune";

export function mount(element, app) {
  const { store, socket, say } = app;
  const on = choice("Tune on", (tuneOn) => store.set({ tuneOn }));
  const tracker = textField("Tracker", "editor, a rule base, or kalman-cv:sigma_v=2", (text) => put({ tracker: text }));
  const free = textField("Numbers to tune", "all; or e.g. outputs, E.ns", (text) => put({ free: text }));
  const whole = { least: 1, whole: true };
  const trials = numberField("Trials", "", (value) => put({ trials: value }), whole);
  const folds = numberField("Folds", "", (value) => put({ folds: value }), { least: 2, whole: true });
  const runs = numberField("Runs", "", (value) => put({ runs: value }), { ...whole, title: "Runs of the scenario" });
  const start = action("Tune", run, { class: "primary" });
  const cancel = html("button", { type: "button", onclick: stop }, "Cancel");
  const bar = html("progress", { max: 1, "aria-label": "Progress of tuning" });
  const words = html("p", { class: "muted", role: "status" });
  const found = html("div", { class: "tuned" });

  element.append(
    html("header", {}, html("h2", {}, title), html("span", { class: "space" }), start, cancel),
    html(
      "div",
      { class: "side" },
      html("div", { class: "progress" }, bar, words),
      found,
      group(
        "What",
        html("div", { class: "field" }, html("span", { class: "label" }, "On"), on.element),
        tracker.element,
        free.element,
        html("div", { class: "form-grid" }, trials.element, folds.element, runs.element),
      ),
    ),
  );

  function put(change) {
    store.set({ tuning: { ...store.now.tuning, ...change } });
  }

  async function run() {
    const { tuning, tuneOn, recording, seed, sigma } = store.now;
    if (tuneOn === "recording" && !recording) {
      say("There is no recording to tune on: drop or choose one, or tune on the scenario.", "error");
      return;
    }
    const { free: numbers, ...rest } = tuning;
    const place = tuneOn === "recording" ? { on: recording, sigma } : { on: null };
    try {
      await socket.send("tune", { ...place, ...rest, free: numbers.trim() || null, seed });
    } catch (error) {
      say(error.message, "error");
    }
  }

  async function stop() {
    try {
      store.set({ job: (await socket.send("cancel", { job: store.now.job.id })).job });
    } catch (error) {
      say(error.message, "error");
    }
  }

  async function openInEditor(text) {
    if (await app.edit("set_text", { text })) say("The tuned rule base is in the editor; undo takes it back.");
    app.show({ tab: "table" });
  }

  store.follow(["tuneOn"], ({ tuneOn }) =>
    on.show([["scenario", "the scenario"], ["recording", "the recording"]], tuneOn),
  );
  store.follow(["tuning"], ({ tuning }) => {
    tracker.show(tuning.tracker);
    free.show(tuning.free);
    trials.show(tuning.trials);
    folds.show(tuning.folds);
    runs.show(tuning.runs);
  });
  store.follow(["job"], ({ job }) => {
    const own = job?.kind === "tune";
    const running = own && job.state === "running";
    start.hidden = running;
    cancel.hidden = !running;
    bar.hidden = !running;
    if (running && job.done) bar.value = job.done / job.of;
    else bar.removeAttribute("value");
    words.textContent = own ? told(job) : "";
    words.classList.toggle("failed", own && job.state === "failed");
    if (own && job.results) store.set({ tuned: job.results });
  });
  store.follow(["tuned"], ({ tuned }) => {
    found.hidden = !tuned;
    if (!tuned) return;
    const open = html("button", { type: "button", class: "primary", onclick: () => openInEditor(tuned.text) }, "Open in the editor");
    found.replaceChildren(table(tuned), ...(tuned.text ? [open] : []));
  });
}

function textField(label, placeholder, change) {
  const input = html("input", {
    type: "text",
    placeholder,
    spellcheck: "false",
    autocomplete: "off",
    onchange: () => change(input.value.trim()),
  });
  const show = (text) => {
    if (document.activeElement !== input) input.value = text ?? "";
  };
  return { element: html("label", { class: "field" }, html("span", { class: "label" }, label), input), show };
}

function table({ rows }) {
  return html(
    "table",
    { class: "result-table" },
    html("caption", {}, "Error on what it was not tuned on"),
    html(
      "tbody",
      {},
      rows.map(({ name, value, se, unit }) =>
        html(
          "tr",
          {},
          html("th", { scope: "row" }, name),
          html("td", {}, shown(value, 4), Number.isFinite(se) ? html("span", { class: "se" }, ` ± ${shown(se, 2)}`) : null, ` ${unit ?? ""}`),
        ),
      ),
    ),
  );
}
