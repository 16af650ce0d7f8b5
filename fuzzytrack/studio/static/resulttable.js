/* The table of results: a row a tracker, with standard errors, operations and marks. */

import { html } from "./elements.js";
import { swatch } from "./lines.js";
import { even, placesOf, shown, withPlaces } from "./numbers.js";

// Significant digits of a value without a standard error, and of a standard error.
const [DIGITS, DIGITS_OF_ERROR] = [4, 2];
// Key of the row, heading, unit, what it says. With a standard error if `${key}_se` is there.
const COLUMNS = [
  ["predicted_rmse", "RMSE predicted", "m", "Root mean square distance of the predictions to the truth"],
  ["filtered_rmse", "RMSE filtered", "m", "Root mean square distance of the estimates to the truth"],
  ["change", "Change", "m", "Mean difference of a run's RMSE of prediction to the first tracker, paired"],
  [
    "operations",
    "Operations",
    "",
    "Floating-point operations of one axis at one scan: scheduler + recursion",
  ],
  ["predicted_mean", "Mean", "m", "Mean distance of the predictions to the truth"],
  ["predicted_variance", "Variance", "m²", "Variance of the distance of the predictions to the truth"],
  ["velocity_rmse", "RMSE velocity", "m/s", "Root mean square error of the velocity"],
  ["cumulative", "Cumulative", "m", "Sum of the distances of a run, averaged over the runs"],
  ["peak", "Peak", "m", "Largest RMSE of prediction of a scan"],
  ["nis", "NIS", "", "Normalized innovation squared, to be compared with the number of axes"],
  ["nees", "NEES", "", "Normalized estimation error squared, to be compared with the number of axes"],
];
const MARKS =
  "Best: the least RMSE predicted. Worse than plots: its RMSE filtered is above that of the plots themselves";
const WORDS = { worse: "worse than plots", "best, worse": "best, worse than plots" };

/** The table; `toggle(name)` shows or hides the lines of a tracker, `hidden` has those hidden. */
export function resultTable(results, hidden, toggle, sorting, sortBy) {
  const rows = results.trackers.map((row, index) => ({
    ...row,
    index,
    mark: results.marks?.[index],
    operations: results.operations?.[row.name]?.per_update ?? null,
    parts: results.operations?.[row.name],
  }));
  const columns = COLUMNS.filter(([key]) => rows.some((row) => Number.isFinite(row[key])));
  const { key, down } = sorting;
  if (key) rows.sort((one, other) => (down ? -1 : 1) * compared(one[key], other[key]));
  return html(
    "table",
    { class: "result-table" },
    html(
      "caption",
      { class: "unseen" },
      `Results of ${results.runs} runs of ${results.scenario}, seed ${results.seed}`,
    ),
    html(
      "thead",
      {},
      html(
        "tr",
        {},
        html("th", { scope: "col" }, sorter("Tracker", null, sorting, sortBy)),
        ...columns.map(([each, text, unit, help]) =>
          html(
            "th",
            {
              scope: "col",
              title: help,
              "aria-sort": key === each ? (down ? "descending" : "ascending") : null,
            },
            sorter(text, each, sorting, sortBy),
            html("small", {}, unit),
          ),
        ),
      ),
    ),
    html(
      "tbody",
      {},
      rows.map((row) => rowOf(row, columns, hidden, toggle)),
    ),
    html(
      "tfoot",
      {},
      html(
        "tr",
        {},
        html("th", { scope: "row" }, "plots"),
        ...columns.map(([each]) =>
          html(
            "td",
            each === "predicted_rmse"
              ? { "data-value": results.measured_rmse, title: String(results.measured_rmse) }
              : {},
            each === "predicted_rmse" ? even(results.measured_rmse, DIGITS) : "",
          ),
        ),
      ),
    ),
  );
}

function sorter(text, key, sorting, sortBy) {
  const sorted = sorting.key === key && key !== null;
  const sign = sorted ? (sorting.down ? " ↓" : " ↑") : "";
  return html("button", { type: "button", class: "link", onclick: () => sortBy(key) }, `${text}${sign}`);
}

/** The name of a tracker with its line, which it shows or hides in the pictures. */
export function lineButton(name, index, off, toggle) {
  return html(
    "button",
    {
      type: "button",
      class: "link",
      "aria-pressed": String(!off),
      title: `${off ? "Show" : "Hide"} ${name} in the pictures`,
      onclick: () => toggle(name),
    },
    swatch(index),
    html("span", {}, name.split(/(?<=:)/).flatMap((word) => [word, html("wbr")])),
  );
}

function rowOf(row, columns, hidden, toggle) {
  const off = hidden.includes(row.name);
  return html(
    "tr",
    { class: `${row.mark ?? ""} ${off ? "off" : ""}`.trim() },
    html(
      "th",
      { scope: "row" },
      html(
        "div",
        {},
        lineButton(row.name, row.index, off, toggle),
        row.mark ? html("span", { class: "mark", title: MARKS }, WORDS[row.mark] ?? row.mark) : null,
      ),
    ),
    ...columns.map(([key]) => cellOf(row, key)),
  );
}

function cellOf(row, key) {
  const value = row[key];
  if (!Number.isFinite(value)) return html("td", {}, "–");
  const error = row[`${key}_se`];
  const known = Number.isFinite(error) && error > 0;
  // The whole number, as the command line writes it, for those who compare.
  const interval = key === "change" ? `, 95 % interval ${row.change_low} to ${row.change_high}` : "";
  const title = `${Number.isFinite(error) ? `${value} ± ${error}` : value}${interval}`;
  const beside = {
    peak: () => (row.peak_time === null ? "" : ` at ${shown(row.peak_time)} s`),
    operations: () => ` (${shown(row.parts.scheduler)} + ${shown(row.parts.recursion)})`,
    nis: () => ` of ${shown(row.nis_expected, 3)}`,
    nees: () => ` of ${shown(row.nees_expected, 3)}`,
  }[key];
  return html(
    "td",
    { title, "data-key": key, "data-value": value },
    key === "operations"
      ? shown(value, DIGITS)
      : known
        ? withPlaces(value, placesOf(error, DIGITS_OF_ERROR))
        : even(value, DIGITS),
    known ? html("span", { class: "se" }, ` ± ${even(error, DIGITS_OF_ERROR)}`) : null,
    beside ? html("span", { class: "se" }, beside()) : null,
  );
}

// What is not known comes last, whichever way it is sorted.
function compared(one, other) {
  if (!Number.isFinite(one)) return 1;
  if (!Number.isFinite(other)) return -1;
  return one - other;
}
