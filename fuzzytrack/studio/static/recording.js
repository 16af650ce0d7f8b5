/* The form of a recording: dropped or chosen in the folder, its columns and the noise of its plots. */

import { html, select } from "./elements.js";
import { group, numberField, textField } from "./fields.js";
import { shown } from "./numbers.js";

// Bytes of a message besides the text of a file.
const OVERHEAD = 1000;
const COLUMNS = [
  ["time", "Time column", "by name", "Column of time, s"],
  ["id", "Track column", "one track", "Column that tells the tracks apart"],
  ["axes", "Position columns", "by name", "Columns of position, m: x,y"],
  ["truth", "Truth columns", "none", "Columns of true position, m: true_x,true_y"],
];

/** What commands are told of the recording: its columns and noise. */
export function columnsOf({ columns, sigma }) {
  const list = (text) => text.split(",").map((word) => word.trim());
  const given = { time: columns.time, id: columns.id };
  if (columns.axes) given.axes = list(columns.axes);
  if (columns.truth) given.truth = list(columns.truth);
  if (sigma !== null) given.sigma = sigma;
  return Object.fromEntries(Object.entries(given).filter(([, value]) => value !== ""));
}

/** The form; `taken()` is called when another recording can be tracked. */
export function recordingForm({ store, socket, say }, taken) {
  const chosen = select("Recording", [], "", (name) => {
    store.set({ recording: name || null, uploaded: null });
    if (name) taken();
  });
  const input = html("input", {
    type: "file",
    accept: ".csv,.txt,text/csv",
    class: "unseen",
    tabindex: -1,
    "aria-label": "CSV file",
    onchange: () => take(input.files[0]),
  });
  const drop = html(
    "button",
    { type: "button", class: "drop", onclick: () => input.click() },
    "Drop a CSV file here, or press to choose one",
  );
  const fields = COLUMNS.map(([key, label, usual, help]) => [
    key,
    textField(label, usual, (text) => setColumn(key, text), help),
  ]);
  const sigma = numberField("Plot σ", "m", (value) => store.set({ sigma: value }), {
    least: 0,
    title: "Standard deviation of the plots; estimated from them if it is left empty",
    empty: true,
  });
  sigma.input.placeholder = "estimated";
  const problem = html("p", { class: "failed", role: "alert" });
  const known = html("p", { class: "muted" });
  const element = group(
    "Recording",
    drop,
    input,
    html("label", { class: "field" }, html("span", { class: "label" }, "File"), chosen),
    problem,
    known,
    html(
      "div",
      { class: "form-grid" },
      fields.map(([, field]) => field.element),
      sigma.element,
    ),
  );

  async function setColumn(key, text) {
    store.set({ columns: { ...store.now.columns, [key]: text } });
    // With another column it may be read now.
    if (store.now.uploaded?.problem) await upload(store.now.uploaded.name, store.now.uploaded.text);
  }

  async function take(file) {
    input.value = "";
    if (!file) return;
    const text = await file.text();
    const most = store.now.hello.limits.message - OVERHEAD;
    if (JSON.stringify(text).length > most) {
      say(
        `${file.name} is too large to be dropped (${shown(file.size / 1e6, 3)} MB; about 1 MB fits). Put it into the folder and choose it.`,
        "error",
      );
      return;
    }
    store.set({ columns: { time: "", id: "", axes: "", truth: "" } });
    await upload(file.name, text);
  }

  async function upload(name, text) {
    try {
      const { sigma: _, ...columns } = columnsOf(store.now);
      const found = await socket.send("upload", { name, text, ...columns });
      store.set({
        uploaded: { ...found, text },
        uploads: [...new Set([...store.now.uploads, found.name])],
        recording: found.name,
      });
      if (!found.problem) taken();
    } catch (error) {
      say(error.message, "error");
    }
  }

  function dragged(event) {
    event.preventDefault();
    drop.classList.toggle("over", event.type === "dragover");
    if (event.type === "drop") take(event.dataTransfer.files[0]);
  }

  store.follow(["files", "uploads", "recording"], ({ files, uploads, recording }) => {
    const inFolder = files.filter(({ kind }) => kind === "recording").map(({ name }) => name);
    const names = [...new Set([...uploads, ...inFolder])];
    chosen.replaceChildren(
      html("option", { value: "" }, "none"),
      ...names.map((name) => html("option", { value: name }, name)),
    );
    chosen.value = names.includes(recording) ? recording : "";
  });
  store.follow(["columns", "sigma"], ({ columns, sigma: given }) => {
    for (const [key, field] of fields) field.show(columns[key]);
    sigma.show(given);
  });
  store.follow(["uploaded"], ({ uploaded }) => {
    problem.hidden = !uploaded?.problem;
    problem.textContent = uploaded?.problem
      ? `${uploaded.problem}. Name the columns below if others are meant.`
      : "";
    known.hidden = !uploaded;
    known.textContent = uploaded ? `Columns: ${uploaded.columns.join(", ")}` : "";
  });

  return { element, dragged };
}
