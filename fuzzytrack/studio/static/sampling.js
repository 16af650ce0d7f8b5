/* The form of the sampling: when the target is measured. */

import { html, select } from "./elements.js";
import { group, numberField } from "./fields.js";

// Patterns, and their numbers: label, unit, what a new one begins with, help.
const PATTERNS = {
  regular: ["regular", []],
  jitter: [
    "jitter",
    [["Share", "", 0.3, "Each scan is early or late by up to this share of the period, below 0.5"]],
  ],
  alternate: [
    "alternating",
    [
      ["Short", "", 1, "Lengths of two intervals that take turns"],
      ["Long", "", 10, "As many times as long"],
    ],
  ],
  burst: [
    "bursts",
    [
      ["Plots", "", 5, "Plots of a burst"],
      ["Gap", "×", 20, "After a burst, as many times as long as between its plots"],
    ],
  ],
  "log-uniform": [
    "log-uniform",
    [
      ["Shortest", "", 1, "Each interval is drawn uniformly in its logarithm"],
      ["Longest", "", 10, "As many times as long"],
    ],
  ],
};

export function samplingForm({ store, scenario }) {
  const kind = select(
    "Intervals",
    Object.entries(PATTERNS).map(([key, [text]]) => [key, text]),
    "regular",
    setKind,
  );
  const numbers = [0, 1].map((which) =>
    numberField("", "", (value) => send({ values: replaced(now().values, which, value) }), { least: 0 }),
  );
  const period = numberField("Mean period", "s", (value) => send({ period: value }), {
    least: 1e-6,
    title: "Mean time between scans; that of the target if it is left alone",
  });
  const element = group(
    "Sampling",
    html(
      "div",
      { class: "form-grid" },
      html("label", { class: "field" }, html("span", { class: "label" }, "Intervals"), kind),
      period.element,
      ...numbers.map((field) => field.element),
    ),
  );

  function now() {
    const sampling = store.now.scenario?.sampling ?? {};
    const key = Object.keys(PATTERNS).find((each) => sampling[each] !== undefined) ?? "regular";
    return { kind: key, values: [sampling[key] ?? []].flat(), period: sampling.period };
  }

  function setKind(value) {
    send({ kind: value, values: PATTERNS[value][1].map(([, , begin]) => begin) });
  }

  function send(change) {
    const { kind: key, values, period: mean } = { ...now(), ...change };
    const pattern = key === "regular" ? {} : { kind: key, value: values.length > 1 ? values : values[0] };
    scenario.change("set_sampling", { ...pattern, ...(mean === undefined ? {} : { period: mean }) });
  }

  function show() {
    const { kind: key, values, period: mean } = now();
    kind.value = key;
    const [begin, next] = store.now.scenario.scenario.time;
    period.show(mean ?? (key === "regular" ? next - begin : null));
    numbers.forEach((field, k) => {
      const about = PATTERNS[key][1][k];
      field.element.hidden = !about;
      if (!about) return;
      field.name(about[0], about[1], about[3]);
      field.show(values[k]);
    });
  }

  return { element, show };
}

function replaced(values, which, value) {
  return values.map((each, k) => (k === which ? value : each));
}
