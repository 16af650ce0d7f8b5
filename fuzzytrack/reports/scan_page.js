// The page: time, controls, keys, and the table of tracks.

const run = new Run(JSON.parse(document.getElementById("data").textContent));
const at = (id) => document.getElementById(id);
const map = new RadarMap(at("view"), run);
const state = { scan: 0, chosen: -1, playing: false, trail: 30, plots: true, static: true,
  tentative: true, truth: true };
const SHOWN = 100;
let clock = run.times[0] ?? 0, before = 0, waiting = false, stale = true;

function request() {
  stale = true;
  wait();
}

// Draw at the next frame what has changed until then.
function wait() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame((now) => {
    waiting = false;
    const shown = state.scan;
    if (state.playing) advance(now);
    if (stale || state.scan !== shown) update();
    stale = false;
    if (state.playing) wait();
  });
}

function advance(now) {
  clock += Math.min(0.25, (now - before) / 1000) * Number(at("speed").value);
  before = now;
  state.scan = run.scanAt(clock);
  if (state.scan >= run.scans - 1) play(false);
}

function play(on) {
  if (on && state.scan >= run.scans - 1) goTo(0);
  state.playing = on;
  before = performance.now();
  at("play").textContent = on ? "Pause" : "Play";
  at("now").setAttribute("aria-live", on ? "off" : "polite");
  request();
}

function goTo(scan) {
  state.scan = Math.min(run.scans - 1, Math.max(0, scan));
  clock = run.times[state.scan];
  request();
}

function choose(track) {
  state.chosen = track;
  request();
}

// ---------------------------------------------------------------- what is shown

function timeText(seconds) {
  const past = seconds - run.times[0];
  if (past < 600) return `${past.toFixed(1)} s`;
  const two = (value) => String(Math.floor(value)).padStart(2, "0");
  return `${Math.floor(past / 3600)}:${two(past / 60 % 60)}:${two(past % 60)}`;
}

function update() {
  map.draw(state);
  const rows = map.shownRows(state);
  const slider = at("slider");
  slider.value = state.scan;
  const moving = rows.filter((row) => run.kind[row] === MOVING).length;
  const text = `scan ${state.scan + 1} of ${run.scans}, ${timeText(run.times[state.scan])}`;
  slider.setAttribute("aria-valuetext", text);
  if (at("now").textContent !== text) at("now").textContent = text;
  at("view").setAttribute("aria-label", `Map: ${text}; ${rows.length} tracks, ${moving} moving. ` +
    "Drag to move, scroll to zoom.");
  fillTable(rows);
  fillChosen();
}

const lines = new Map();
let listed = "";

function fillTable(rows) {
  const rank = [2, 0, 1];
  rows.sort((a, b) => rank[run.kind[a]] - rank[run.kind[b]] || run.track[a] - run.track[b]);
  const shown = rows.slice(0, SHOWN);
  const body = at("tracks");
  const key = shown.map((row) => run.track[row]).join();
  if (key !== listed) {
    const focused = document.activeElement;
    body.replaceChildren(...shown.map((row) => lineOf(run.track[row])));
    if (focused !== document.activeElement && focused.isConnected) focused.focus();
    listed = key;
  }
  for (const row of shown) {
    const line = lineOf(run.track[row]), cells = line.cells;
    line.className = run.track[row] === state.chosen ? "chosen" : "";
    cells[0].firstChild.setAttribute("aria-pressed", String(run.track[row] === state.chosen));
    put(cells[1], KINDS[run.kind[row]]);
    put(cells[2], STATUSES[run.status[row]]);
    put(cells[3], run.speed(row).toFixed(1));
    put(cells[4], courseText(row));
  }
  put(at("more"), rows.length > SHOWN ? `and ${rows.length - SHOWN} more` :
    rows.length ? "" : "No track in this scan.");
}

// What stands still has no course.
function courseText(row) {
  if (run.kind[row] === STATIC || run.speed(row) < 0.05) return "\u2013";
  return `${Math.round(run.course(row)) % 360}\u00b0`;
}

function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

function lineOf(track) {
  if (lines.has(track)) return lines.get(track);
  const line = document.createElement("tr");
  const head = document.createElement("th");
  head.scope = "row";
  const button = document.createElement("button");
  button.className = "pick";
  button.textContent = run.ids[track];
  button.setAttribute("aria-label", `track ${run.ids[track]}`);
  button.addEventListener("click", () => choose(state.chosen === track ? -1 : track));
  head.append(button);
  line.append(head);
  for (const kind of ["", "", "number", "number"]) {
    const cell = document.createElement("td");
    cell.className = kind;
    line.append(cell);
  }
  if (lines.size > 5000) lines.clear();
  lines.set(track, line);
  return line;
}

function fillChosen() {
  const track = state.chosen;
  at("nothing").hidden = track >= 0;
  at("numbers").hidden = at("unchoose").hidden = track < 0;
  if (track < 0) {
    put(at("heading"), "Track");
    return;
  }
  put(at("heading"), `Track ${run.ids[track]}`);
  const facts = factsOf(track);
  const list = at("numbers");
  if (list.children.length !== 2 * facts.length) {
    list.replaceChildren(...facts.flatMap(() =>
      [document.createElement("dt"), document.createElement("dd")]));
  }
  facts.forEach(([name, value], k) => {
    put(list.children[2 * k], name);
    put(list.children[2 * k + 1], value);
  });
}

function factsOf(track) {
  const from = run.trackFrom[track], to = run.trackFrom[track + 1];
  const first = run.scanOf[run.byTrack[from]], last = run.scanOf[run.byTrack[to - 1]];
  const life = ["reported", `${timeText(run.times[first])} to ${timeText(run.times[last])}`];
  const row = run.rowOf(track, state.scan);
  if (row < 0) return [["status", "not reported in this scan"], life];
  const [across, up] = run.data.axes, origin = run.data.origin;
  const chance = run.existence[row];
  return [
    ["kind", KINDS[run.kind[row]]],
    ["status", STATUSES[run.status[row]]],
    [across, `${(run.place[2 * row] + origin[0]).toFixed(1)} m`],
    [up, `${(run.place[2 * row + 1] + origin[1]).toFixed(1)} m`],
    ["standard deviation", `${run.deviation[row].toFixed(1)} m`],
    ["speed", `${run.speed(row).toFixed(2)} m/s`],
    ["course", courseText(row)],
    ["existence", chance > 100 ? "not known" : `${chance} %`],
    ["last plot", run.since[row] > 0 ? `${run.since[row].toFixed(1)} s before` : "in this scan"],
    life,
  ];
}

// ---------------------------------------------------------------- controls

function fillControls() {
  const slider = at("slider");
  slider.max = Math.max(0, run.scans - 1);
  const span = run.scans ? run.times[run.scans - 1] - run.times[0] : 0;
  const speeds = [...at("speed").options].map((option) => Number(option.value));
  at("speed").value = speeds.find((speed) => span / speed <= 40) ?? speeds[speeds.length - 1];
  at("truth").parentElement.hidden = run.truthFrom.length < 2;
  at("truth-key").hidden = run.truthFrom.length < 2;
  put(at("vector"), `line: where it is in ${map.vector} s`);
  slider.addEventListener("input", () => goTo(Number(slider.value)));
  at("play").addEventListener("click", () => play(!state.playing));
  at("back").addEventListener("click", () => goTo(state.scan - 1));
  at("forward").addEventListener("click", () => goTo(state.scan + 1));
  at("trail").addEventListener("change", () => {
    state.trail = Number(at("trail").value);
    request();
  });
  for (const name of ["plots", "static", "tentative", "truth"]) {
    at(name).addEventListener("change", () => {
      state[name] = at(name).checked;
      request();
    });
  }
  at("in").addEventListener("click", () => (map.zoom(1.5), request()));
  at("out").addEventListener("click", () => (map.zoom(1 / 1.5), request()));
  at("fit").addEventListener("click", () => (map.fit(), request()));
  at("unchoose").addEventListener("click", () => choose(-1));
}

function watchKeys() {
  const keys = {
    ArrowRight: (event) => goTo(state.scan + (event.shiftKey ? 10 : 1)),
    ArrowLeft: (event) => goTo(state.scan - (event.shiftKey ? 10 : 1)),
    Home: () => goTo(0),
    End: () => goTo(run.scans - 1),
    "+": () => map.zoom(1.5),
    "=": () => map.zoom(1.5),
    "-": () => map.zoom(1 / 1.5),
    0: () => map.fit(),
    Escape: () => choose(-1),
    " ": () => play(!state.playing),
  };
  document.addEventListener("keydown", (event) => {
    const focus = event.target.closest("button, select, input");
    // What has the focus uses these keys itself.
    const own = focus && (focus.matches("select") || (event.key === " " &&
      focus.matches("button, [type=checkbox]")));
    if (own || event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
    event.preventDefault();
    keys[event.key](event);
    request();
  });
}

function watchPointer() {
  const canvas = at("view"), down = new Map();
  let dragged = false;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    map.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...place(event));
    request();
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, place(event));
    dragged = down.size > 1;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!down.has(event.pointerId)) {
      canvas.style.cursor = map.pick(...place(event), state) >= 0 ? "pointer" : "";
      return;
    }
    const [x, y] = place(event), [u, v] = down.get(event.pointerId);
    const others = [...down].filter(([id]) => id !== event.pointerId).map(([, where]) => where);
    if (!dragged && Math.hypot(x - u, y - v) < 4) return;
    dragged = true;
    if (others.length) {
      const [a, b] = others[0];
      const factor = Math.hypot(x - a, y - b) / Math.max(1, Math.hypot(u - a, v - b));
      map.zoom(factor, (x + a) / 2, (y + b) / 2);
    } else map.pan(x - u, y - v);
    down.set(event.pointerId, [x, y]);
    request();
  });
  canvas.addEventListener("pointerup", (event) => {
    if (down.delete(event.pointerId) && !dragged) choose(map.pick(...place(event), state));
  });
  canvas.addEventListener("pointercancel", (event) => down.delete(event.pointerId));
}

fillControls();
watchKeys();
watchPointer();
new ResizeObserver(request).observe(at("view"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  map.readColors();
  request();
});
goTo(Number(run.data.scan));
