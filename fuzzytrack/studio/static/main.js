/* Start of the page: the connection, the store, the views, the keys of the whole page. */

import { makeEdits } from "./edits.js";
import { choice, html } from "./elements.js";
import { followPoint } from "./explain.js";
import * as files from "./files.js";
import { takeBackByEscape } from "./focus.js";
import { endLost, takeJob } from "./jobbar.js";
import { RECORDED } from "./pick.js";
import { followScenario } from "./scenario.js";
import { connect } from "./socket.js";
import { makeStore } from "./store.js";
import { followValues } from "./values.js";
import { isShown, mountViews } from "./views.js";

const INITIAL = {
  // From the server.
  connected: false, session: null, opened: { rules: null, scenario: null }, hello: null, state: null, files: [], shipped: [], values: null,
  valuesError: null, explanation: null, gains: null, visits: null, runs: 0,
  scenario: null, job: null, jobs: {}, results: null, asked: null, ranWith: null, tracked: null, tuned: null, uploads: [],
  // What is looked at.
  view: "design", tab: "table", line: null, cell: null, variable: null, set: null, shown: null, colorBy: null,
  against: null, axes: null, point: null, camera: { azimuth: -125, elevation: 30, zoom: 1 }, planeRange: "whole",
  resultsTab: "all", hidden: [], sorting: { key: null, down: false }, quantity: "predicted", band: "se",
  gain: "alpha", pair: [null, null], walked: { tracker: null, run: 0 }, recording: null, described: null, working: false, trackShown: 0,
  axisShown: 0,
  // How.
  points: 41, dragging: false, symmetric: false, several: false, snap: "grid", linked: false, mirror: false, shared: "both",
  shadeVisits: false, palette: "viridis", scheme: "light",
  trackers: [], recordedTrackers: RECORDED, wantedRuns: 200, seed: 0, readings: {}, tuneOn: "scenario",
  tuning: { tracker: "editor", free: "", trials: 100, folds: 5, runs: 60 },
};
const KEPT = [
  "session", "opened", "view", "tab", "cell", "variable", "set", "shown", "colorBy", "against", "axes", "point", "camera",
  "planeRange", "points", "symmetric", "snap", "linked", "mirror", "shared", "shadeVisits", "palette",
  "asked", "ranWith", "resultsTab", "hidden", "sorting", "quantity", "band", "gain", "pair", "walked", "recording",
  "trackers", "recordedTrackers", "wantedRuns", "seed", "readings", "uploads", "tuneOn", "tuning",
];
const SCHEME = "fuzzytrack scheme";

const store = makeStore(INITIAL, KEPT, "fuzzytrack");
const status = document.getElementById("status");
const message = html("span", { class: "message", role: "status", "aria-live": "polite" });
const line = html("span", { class: "line" });
status.append(line, message);

/** Say something in the line at the bottom; `kind` is "error" for what went wrong. */
function say(text, kind = "note") {
  message.textContent = text;
  message.className = `message ${kind}`;
}

const token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
const socket = connect(token, heard);
const { edit, drawn } = makeEdits(socket, store, say, followValues(socket, store, say));
const app = {
  socket, store, say, edit, drawn, isShown, tabs,
  can: (command) => store.now.hello?.commands?.includes(command) ?? false,
  show: (change) => store.set({ view: "design", ...change }),
  wantedScheme: () => localStorage.getItem(SCHEME),
  setScheme,
  /** Show or hide the lines of a tracker in all pictures. */
  toggleLine: (name) => {
    const { hidden } = store.now;
    store.set({ hidden: hidden.includes(name) ? hidden.filter((each) => each !== name) : [...hidden, name] });
  },
};
Object.assign(app, followPoint(app), { scenario: followScenario(app) });

/** Tabs of the rules: the table, or the text it stands in. Each pane has them. */
function tabs() {
  const element = choice("Rules as", (tab) => {
    store.set({ tab });
    document.querySelector(".pane:not([hidden]) .rules-tabs [aria-pressed=true]").focus();
  });
  element.element.classList.add("rules-tabs");
  store.follow(["tab"], ({ tab }) => element.show([["table", "Table"], ["text", "Text"]], tab));
  return element.element;
}

// ---------------------------------------------------------------------- the server

function heard(event, news) {
  if (event === "open") greet();
  else if (event === "close") lose();
  else if (event === "notice") say(news.text, "error");
  else if (event === "job") takeJob(store, news.job);
}

function lose() {
  store.set({ connected: false });
  // A server that is there but has never answered does not know the token.
  if (!store.now.hello) {
    say("No answer: open the whole address that `fuzzytrack studio` printed, with its token.", "error");
  }
}

async function greet() {
  try {
    const { session: before, opened } = store.now;
    const hello = await socket.send("hello", { session: before });
    const { session, state, files: found, shipped } = hello;
    store.set({ hello, session, state, files: found, shipped, connected: true });
    for (const job of hello.jobs) takeJob(store, job);
    endLost(store, hello.jobs);
    document.body.classList.add("ready");
    seeVisits();
    if (before && session !== before) await reopen(opened);
  } catch (error) {
    say(error.message, "error");
  }
}

/** Open what was open, where a server that was started anew does not know the page; drafts it does. */
async function reopen({ rules, scenario }) {
  const { state, scenario: now } = store.now;
  if (rules && rules !== state.name) await edit("open", { name: rules });
  if (scenario && scenario !== now.name) await app.scenario.change("open_scenario", { name: scenario });
}

/** The files of the folder, where other programs may have written meanwhile. */
async function listFiles() {
  if (store.now.connected) store.set(await socket.send("files").catch(() => ({})));
}

addEventListener("focus", listFiles);

/** Where the last run went, for the shading of surfaces. */
async function seeVisits() {
  if (!app.can("visits")) return;
  const visits = await socket.send("visits").catch(() => null);
  store.set({ visits: visits?.counts?.length ? visits : null });
}

store.follow(["job"], ({ job }) => {
  if (job?.kind !== "run" || job.state !== "done") return;
  store.set({ runs: store.now.runs + 1 });
  seeVisits();
});

store.follow(["state", "scenario"], ({ state, scenario }) => {
  const { rules, scenario: world } = store.now.opened;
  if (!state || !scenario || (rules === state.name && world === scenario.name)) return;
  store.set({ opened: { rules: state.name, scenario: scenario.name } });
});

store.follow(["connected", "hello"], ({ connected, hello }) => {
  line.textContent = connected ? "connected" : hello ? "no connection: trying again" : "connecting";
  line.classList.toggle("off", !connected);
});

// What went wrong is over with the next change that is made.
store.follow(["state", "view"], () => message.classList.contains("error") && say(""));

// ---------------------------------------------------------------------- looks

const dark = matchMedia("(prefers-color-scheme: dark)");

function setScheme(wanted) {
  if (wanted) localStorage.setItem(SCHEME, wanted);
  else localStorage.removeItem(SCHEME);
  const scheme = wanted ?? (dark.matches ? "dark" : "light");
  document.documentElement.dataset.scheme = scheme;
  store.set({ scheme });
}

setScheme(app.wantedScheme());
dark.addEventListener("change", () => setScheme(app.wantedScheme()));

// ---------------------------------------------------------------------- the page

const bar = files.mount(document.getElementById("bar"), app);
mountViews(document.getElementById("rail"), document.getElementById("main"), app);
takeBackByEscape();

document.addEventListener("keydown", (event) => {
  if (document.querySelector("dialog[open]")) return;
  // Numbers are kept as soon as they are typed, so undo in their fields is that of the page.
  const typing = event.target.matches?.("input:not(.number, [type=checkbox]), textarea");
  const key = event.key.toLowerCase();
  if (event.ctrlKey || event.metaKey) {
    const run = {
      s: bar.save,
      o: bar.open,
      z: typing ? null : () => edit(event.shiftKey ? "redo" : "undo"),
      y: typing ? null : () => edit("redo"),
    }[key];
    if (!run) return;
    event.preventDefault();
    run();
  } else if (event.key === "?" && !typing && !event.target.closest("[role=gridcell]")) bar.help();
});
