/* The form of a recording: dropped or chosen in the folder, its columns, noise and faults. */

import { argumentsOf, inFields, NOTHING, POSITIONS, readingOf, remedies } from "./columns.js";
import { check, html, select } from "./elements.js";
import { keepText } from "./files.js";
import { group, numberField, numberOrColumn, textField } from "./fields.js";
import { shown } from "./numbers.js";

// Bytes of a message besides the text of a file.
const OVERHEAD = 1000;
const CHOICES = {
  azimuth_from: [
    ["", "north"],
    ["east", "east"],
  ],
  time_unit: [
    ["", "automatic"],
    ["s", "s"],
    ["ms", "ms"],
    ["us", "µs"],
    ["ns", "ns"],
  ],
  duplicates: [
    ["", "refused"],
    ["first", "the first plot"],
    ["last", "the last plot"],
    ["mean", "their mean"],
  ],
};

const NOISE =
  "Standard deviation of the plots, or the column that has it; with commas, one for each axis. Estimated from the plots if it is empty";

/** The form; `taken()` is called when a recording can be tracked. */
export function recordingForm(app, taken) {
  const { store, socket, say } = app;
  const chosen = select("File", [], "", choose);
  const input = html("input", {
    type: "file",
    accept: ".csv,text/csv",
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
  const problem = html("div", { class: "failed", role: "alert" });
  const columns = ["time", "id"].map((key) => select("", [], "", (value) => put({ [key]: value })));
  const position = select(
    "Positions",
    Object.entries(POSITIONS).map(([key, { text }]) => [key, text]),
    "axes",
    (value) => put({ position: value, places: ["", "", ""] }),
  );
  const places = [0, 1, 2].map((k) =>
    select("", [], "", (value) => {
      put({ places: readingOf(store.now).places.map((each, j) => (j === k ? value : each)) });
    }),
  );
  const placeFields = places.map((each) => field("", each));
  const names = html("datalist", { id: "columns-of-recording" });
  const noise = [0, 1, 2].map((k) => numberOrColumn(names.id, (value) => putNoise(k, value)));
  const own = [0, 1, 2].map((k) =>
    select("", [], "", (value) => {
      put({ own_ship: readingOf(store.now).own_ship.map((each, j) => (j === k ? value : each)) });
    }),
  );
  const heading = select("", [], "", (value) => put({ own_heading: value }));
  const truth = textField(
    "Truth",
    "none",
    (text) => put({ truth: text }),
    "Columns with the true positions, such as true_x,true_y, or a CSV file of the folder",
  );
  const choices = Object.fromEntries(
    Object.entries(CHOICES).map(([key, options]) => [
      key,
      select("", options, "", (value) => put({ [key]: value })),
    ]),
  );
  choices.azimuth_from.title = "Azimuths grow clockwise from north, or counterclockwise from east";
  const azimuth = field("Azimuth from", choices.azimuth_from);
  const gap = numberField("Longest gap", "s", (value) => put({ max_gap: value }), {
    least: 0,
    empty: true,
    title: "A longer time without a plot ends the track",
  });
  const wrap = numberField("Clock restarts after", "s", (value) => put({ wrap: value }), {
    least: 0,
    empty: true,
    title: "Period of a clock that starts again, such as 86400; midnight and counters are recognized",
  });
  gap.input.placeholder = wrap.input.placeholder = "automatic";
  const sort = check("Sort by time", false, (value) => put({ sort: value }));
  const form = html(
    "div",
    { class: "form-grid" },
    field("Time column", columns[0]),
    field("Track column", columns[1]),
    field("Positions", position),
    azimuth,
    html("div", { class: "triple" }, placeFields),
    noise.map(({ element }) => element),
    truth.element,
  );
  const faults = html(
    "details",
    {},
    html("summary", {}, "Units and faults"),
    html(
      "div",
      { class: "form-grid" },
      field("Unit of time", choices.time_unit),
      field("Plots at equal times", choices.duplicates),
      gap.element,
      wrap.element,
      html("div", { class: "field" }, html("span", { class: "label" }, "Order"), sort),
    ),
  );
  const moving = html(
    "details",
    { title: "Columns with the place of the sensor, to which the plots are added" },
    html("summary", {}, "Moving sensor"),
    html(
      "div",
      { class: "form-grid" },
      ["Own x or latitude", "Own y or longitude", "Own z or altitude"].map((label, k) => field(label, own[k])),
      field("Own heading", heading),
    ),
  );
  const element = group(
    "Recording",
    drop,
    input,
    field("File", chosen),
    problem,
    form,
    moving,
    faults,
    names,
  );
  // Numbers of questions, of which the last one counts.
  let asked = 0;

  /** Show the command for plots of which nothing says which target they are of. */
  function scanCommand() {
    const args = { what: "command", of: "scan", name: store.now.recording, ...argumentsOf(store.now) };
    keepText(app, "snippet", args, "Tracks of plots without identities");
  }

  /** Say something else of the recording, and read it again. */
  function put(change) {
    const { recording, readings } = store.now;
    if (!recording) return;
    store.set({ readings: { ...readings, [recording]: { ...readingOf(store.now), ...change } } });
    look();
  }

  function putNoise(k, value) {
    const { position: kind, noise: known } = readingOf(store.now);
    put({ noise: { ...known, [POSITIONS[kind].noise[k][0]]: value } });
  }

  function choose(name) {
    say("");
    store.set({ recording: name || null, described: null, tracked: null });
    if (!name) return;
    store.set({ tuneOn: "recording" });
    look();
  }

  /** Ask what is in the recording, and let it be tracked if it can be read. */
  async function look() {
    const name = store.now.recording;
    if (await ask("recording", { name, ...argumentsOf(store.now) })) taken();
  }

  /** Ask what is in a recording; whether it can be read, and nothing else was asked meanwhile. */
  async function ask(command, args) {
    const number = (asked += 1);
    store.set({ working: true });
    let described = null;
    try {
      described = await socket.send(command, args);
    } catch (error) {
      described = { name: args.name, columns: [], problem: error.message };
    }
    if (number !== asked) return false;
    store.set({ described, working: false, ...(described.problem ? { tracked: null } : {}) });
    return !described.problem;
  }

  async function take(file) {
    input.value = "";
    if (!file) return;
    if (!/\.csv$/i.test(file.name)) {
      say(`${file.name} is no CSV file. Put rule bases and scenarios into the folder, and open them.`, "error");
      return;
    }
    store.set({ view: "data" });
    const text = await file.text();
    const most = store.now.hello.limits.message - OVERHEAD;
    if (JSON.stringify(text).length > most) {
      say(
        `${file.name} is too large to be dropped (${shown(file.size / 1e6, 3)} MB; about 1 MB fits). Put it into the folder and choose it.`,
        "error",
      );
      return;
    }
    const { uploads, readings } = store.now;
    store.set({
      recording: file.name,
      tuneOn: "recording",
      described: null,
      tracked: null,
      uploads: [...new Set([...uploads, file.name])],
      readings: { ...readings, [file.name]: NOTHING },
    });
    if (await ask("upload", { name: file.name, text })) taken();
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
  store.follow(["recording", "readings", "described"], (now) => {
    const reading = readingOf(now);
    const { recording, described } = now;
    form.hidden = faults.hidden = moving.hidden = !recording;
    if (!recording) return;
    const { found } = described ?? {};
    const said = [reading.time, reading.id, ...reading.places, ...reading.own_ship, reading.own_heading];
    const known = [...new Set([...(described?.columns ?? []), ...said])].filter((name) => name !== "");
    const options = () => known.map((name) => html("option", { value: name }, name));
    names.replaceChildren(...options());
    const offer = (list, usual, value) => {
      list.replaceChildren(
        html("option", { value: "" }, usual),
        ...options(),
      );
      list.value = value;
    };
    const byName = (name) => (name ? `by name: ${name}` : "by name");
    offer(columns[0], byName(found?.time), reading.time);
    offer(columns[1], "one track", reading.id);
    position.value = reading.position;
    const kind = POSITIONS[reading.position];
    kind.places.forEach((name, k) => {
      const usual = reading.position === "axes" ? byName(found?.places[k]) : "choose";
      const none = k === 2 || (k === 1 && found?.places.length === 1);
      offer(places[k], none && !found?.places[k] ? "none" : usual, reading.places[k]);
      placeFields[k].firstChild.textContent = name;
      places[k].setAttribute("aria-label", name);
    });
    noise.forEach(({ element: each, name, show, input: box }, k) => {
      const of = kind.noise[k];
      each.hidden = !of || (k === 2 && reading.places[2] === "");
      if (!of) return;
      name(of[1], of[2], NOISE);
      // Of x and y in one field, both.
      const found = kind.noise.length > 1 ? described?.noise?.slice(k, k + 1) : described?.noise;
      const estimates = (found ?? []).filter((one) => one.error).map((one) => shown(one.sigma, 3));
      box.placeholder = estimates.length ? `≈ ${[...new Set(estimates)].join(", ")}` : "estimated";
      show(reading.noise[of[0]] ?? null);
    });
    own.forEach((list, k) => offer(list, "none", reading.own_ship[k]));
    offer(heading, "none", reading.own_heading);
    azimuth.hidden = reading.position !== "polar";
    position.parentElement.classList.toggle("wide", azimuth.hidden);
    truth.show(reading.truth);
    for (const [key, list] of Object.entries(choices)) list.value = reading[key];
    gap.show(reading.max_gap);
    wrap.show(reading.wrap);
    sort.firstChild.checked = reading.sort;
  });
  store.follow(["described", "working"], ({ described, working }) => {
    problem.hidden = !described?.problem || working;
    const scan = readingOf(store.now).id === "" ? scanCommand : null;
    problem.replaceChildren(...(described?.problem ? withRemedies(described.problem, put, scan) : []));
  });
  // After a reload the recording is read again when it is looked at; its tracks are there still,
  // unless the server was started again.
  store.follow(["view", "hello"], async ({ view, hello, recording: name, described }) => {
    if (view !== "data" || !hello || !name || described) return;
    if ((await ask("recording", { name, ...argumentsOf(store.now) })) && !store.now.tracked) taken();
  });

  return { element, dragged, put };
}

/**
 * A message about a recording, and buttons that say of it what the message proposes; `scan` shows
 * what is to be done where identities are missing.
 */
export function withRemedies(text, put, scan = null) {
  const [rest, found] = remedies(text);
  const sentence = html("span", {}, `${inFields(rest).replace(/[.]$/, "")}.`);
  const press = (label, run) => html("button", { type: "button", onclick: run }, label);
  const buttons = found.map(([label, change]) => press(label, () => put(change)));
  if (scan && text.includes("`id`")) buttons.push(press("No column has it: show the command for plots without identities", scan));
  return buttons.length ? [sentence, html("span", { class: "actions" }, buttons)] : [sentence];
}

function field(label, list) {
  list.setAttribute("aria-label", label);
  return html("label", { class: "field" }, html("span", { class: "label" }, label), list);
}
