/* What can be kept of an experiment: numbers, tables, and the script or command that gives them. */

import { keepText } from "./files.js";
import { download } from "./pictures.js";

/** Entries of a menu for the script and the command of a run, of tracks or of a tuning. */
export function scriptEntries(app, of, args) {
  if (!app.can("snippet")) return [];
  const entry = (text, what) => ({ text, run: () => keepText(app, "snippet", { what, of, ...args }, text) });
  return [entry("Command line", "command"), entry("Python", "python")];
}

/** Entries for the numbers as JSON and the rows of the table as CSV. */
export function numberEntries(name, numbers, rows) {
  return [
    {
      text: "Numbers (JSON)",
      run: () => download(`${name}.json`, JSON.stringify(numbers, null, 1), "application/json"),
    },
    { text: "Table (CSV)", run: () => download(`${name}.csv`, csvOf(rows), "text/csv") },
  ];
}

function csvOf(rows) {
  const columns = [...new Set(rows.flatMap((row) => Object.keys(row)))];
  const cell = (value) => (typeof value === "string" ? `"${value.replaceAll('"', '""')}"` : (value ?? ""));
  return [columns.join(","), ...rows.map((row) => columns.map((key) => cell(row[key])).join(","))].join("\n");
}
