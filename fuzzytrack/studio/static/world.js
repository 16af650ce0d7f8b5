/* The view of the scenario: the target and the sensors on a map, and their numbers beside it. */

import { makeChart } from "./chart.js";
import { html, svg } from "./elements.js";
import { group } from "./fields.js";
import { pathOf } from "./lines.js";
import { boundsOf, distance, makeMap } from "./map.js";
import { shown } from "./numbers.js";
import { pictureMenu, svgFile } from "./pictures.js";
import { openScenario, saveScenario } from "./scenariofiles.js";
import { samplingForm } from "./sampling.js";
import { targetKind, truthOf } from "./scenario.js";
import { radius, sensorForm, sensorLayer } from "./sensors.js";
import { token } from "./colors.js";
import { targetForm } from "./target.js";
import { waypointLayer } from "./waypoints.js";

export const title = "World";
const MOST_DOTS = 300;
const MOST_PAIRS = 1e6;

export function mount(element, app) {
  const { store, scenario, say } = app;
  // Way-points of a path that is being drawn; null if none is.
  let drafted = null;

  const map = makeMap({
    name: "Map of the target and the sensors: arrow keys move it, + and − zoom, 0 shows all",
    bounds: () => boundsOf([...truthOf(store.now.scenario), ...points()]),
    drawing: () => drafted !== null,
    clicked: addPoint,
  });
  const track = svg("g", {});
  const overTime = makeChart();
  map.add(sensorLayer(() => store.now.scenario));
  map.add({ element: track, draw: drawTrack });
  map.add(
    waypointLayer({
      map,
      read: () => ({ points: points(), between: drafted ? [] : middlesOf(store.now.scenario) }),
      write: writePoints,
      draft: (all) => scenario.draft("set_waypoints", { points: all, ...target.timing() }),
    }),
  );
  map.add(
    waypointLayer({
      map,
      named: () => "Start",
      read: () => ({ points: drafted ? [] : target.start(), between: [] }),
      write: ([start]) => target.setStart(start),
    }),
  );
  map.picture.addEventListener("keydown", (event) => {
    if (drafted === null || (event.key !== "Enter" && event.key !== "Escape")) return;
    event.preventDefault();
    finish();
  });

  const draw = html("button", { type: "button", onclick: () => (drafted === null ? begin() : finish()) });
  const facts = html("p", { class: "facts" });
  const target = targetForm(app, points, writePoints);
  const sensors = sensorForm(app);
  const sampling = samplingForm(app);
  const text = textForm(app);
  const complaints = html("ul", { class: "complaints", "aria-live": "polite" });

  element.classList.add("world");
  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      openScenario(app),
      saveScenario(app),
      html("span", { class: "space" }),
      draw,
      pictureMenu(
        "the map",
        () => `${store.now.scenario.name}-map`,
        () => svgFile((map.element.hidden ? overTime : map).picture, token("--panel")),
      ),
    ),
    html(
      "div",
      { class: "beside" },
      html("div", { class: "tall" }, map.element, overTime.element, facts),
      html(
        "div",
        { class: "side" },
        complaints,
        target.element,
        sensors.element,
        sampling.element,
        text.element,
      ),
    ),
  );

  function points() {
    return drafted ?? store.now.scenario?.target?.waypoints ?? [];
  }

  function writePoints(next) {
    if (drafted !== null) drafted = next;
    map.redraw();
    target.show();
    if (next.length < 2) return Promise.resolve(false);
    return scenario.change("set_waypoints", { points: next, ...target.timing() });
  }

  /** A target with one axis has no map; a path that is drawn will have two. */
  function showAxes() {
    const { axes, time, truth } = store.now.scenario.scenario;
    const flat = axes === 1 && drafted === null;
    map.element.hidden = flat;
    overTime.element.hidden = !flat;
    if (!flat) return;
    overTime.show({
      name: "Position of the target over time",
      x: { label: "time (s)" },
      y: { label: "position (m)" },
      series: [{ name: "truth", index: 0, x: time, y: truth.map(([x]) => x) }],
    });
  }

  function begin() {
    drafted = [];
    showDrawing();
    map.picture.focus();
    say("Click the way-points on the map, or put them with arrows and Space; at least two. Enter or Esc ends.");
  }

  function finish() {
    if (drafted.length === 1) say("A path needs two way-points: nothing was changed.", "error");
    else say("");
    drafted = null;
    showDrawing();
  }

  function showDrawing() {
    const on = drafted !== null;
    draw.setAttribute("aria-pressed", String(on));
    draw.textContent = on ? "Done" : "Draw way-points";
    draw.title = on ? "End the path (Enter)" : "Draw a new path: click its way-points on the map, or put them with arrows and Space";
    map.element.classList.toggle("drawing", on);
    target.show();
    if (store.now.scenario) showAxes();
    map.redraw();
  }

  function addPoint({ x, y }) {
    const step = 10 ** Math.ceil(Math.log10(map.place.scale));
    writePoints([...drafted, [x, y].map((value) => Math.round(value / step) * step)]);
  }

  /** Whether the start of the track can be dragged; else it is marked. */
  function hasHandles() {
    return points().length + target.start().length > 0;
  }

  function drawTrack(place) {
    const all = drafted === null || drafted.length > 1 ? truthOf(store.now.scenario) : [];
    const at = all.map(([x, y]) => [place.x(x), place.y(y)]);
    const dots = at.length <= MOST_DOTS ? at : [];
    track.replaceChildren(
      svg("path", { class: "truth", d: pathOf(at) }),
      ...(hasHandles() ? [] : at.slice(0, 1)).map(([x, y]) =>
        svg("path", { class: "scan", d: `M${x - 5} ${y - 5}h10v10h-10z` }),
      ),
      ...dots.map(([cx, cy]) => svg("circle", { class: "scan", cx, cy, r: 2 })),
    );
  }

  let name = null;
  store.follow(["scenario"], ({ scenario: now }) => {
    if (!now) return;
    target.show();
    sensors.show();
    sampling.show();
    text.show();
    facts.textContent = factsOf(now);
    complaints.hidden = !now.complaints.length;
    complaints.replaceChildren(
      ...now.complaints.map(({ message, line }) =>
        html("li", {}, line ? `Line ${line}: ${message}` : message),
      ),
    );
    showAxes();
    // Another scenario is shown whole; a change of this one leaves the map where it is.
    if (name !== now.name) map.fit();
    else map.redraw();
    name = now.name;
  });
  store.follow(["view", "scheme"], () => map.redraw());
  showDrawing();
}

/** The whole text, for all that the forms do not have. */
function textForm({ store, scenario }) {
  const area = html("textarea", {
    class: "mono",
    rows: 14,
    spellcheck: "false",
    "aria-label": "Scenario in YAML",
  });
  const apply = html(
    "button",
    { type: "button", onclick: () => scenario.change("set_scenario_text", { text: area.value }) },
    "Apply",
  );
  const element = group(
    "Text",
    html("details", {}, html("summary", {}, "Scenario in YAML"), area, html("div", { class: "row" }, apply)),
  );

  function show() {
    if (document.activeElement !== area) area.value = store.now.scenario.text;
  }

  return { element, show };
}

function factsOf({ scenario: { scans, tracks, time, truth, sensors } }) {
  const all = truth.map(([x, y = 0]) => [x, y]);
  const length = all.slice(1).reduce((sum, point, k) => sum + apart(all[k], point), 0);
  const words = [`${scans} scans`, `${shown(time.at(-1) - time[0], 5)} s`, `path ${distance(length)}`];
  if (tracks > 1) words.push(`the first of ${tracks} tracks is drawn`);
  if (sensors.kind === "field" && sensors.positions.length * all.length < MOST_PAIRS) {
    const seen = all.filter((point) =>
      sensors.positions.some((at, k) => apart(at, point) <= radius(sensors, k)),
    );
    words.push(`${seen.length} of ${all.length} positions within reach of a sensor`);
    if (all.some((point) => sensors.positions.some((at) => apart(at, point) === 0))) {
      words.push("the target is exactly at a sensor, where it cannot be measured: move one of them");
    }
  }
  return words.join(" · ");
}

/** A place on the track in the middle of each leg. */
function middlesOf(now) {
  if (!now || targetKind(now) !== "waypoints") return [];
  const { waypoints, times } = now.target;
  const { time } = now.scenario;
  const truth = truthOf(now);
  const legs = waypoints.length - 1;
  const ends = times ?? waypoints.map((_, k) => time[0] + (k / legs) * (time.at(-1) - time[0]));
  return waypoints.slice(1).map((_, k) => {
    const middle = (ends[k] + ends[k + 1]) / 2;
    const after = Math.max(
      1,
      time.findIndex((each) => each >= middle),
    );
    const share = (middle - time[after - 1]) / (time[after] - time[after - 1]);
    return [0, 1].map(
      (axis) => truth[after - 1][axis] + share * (truth[after][axis] - truth[after - 1][axis]),
    );
  });
}

function apart(one, other) {
  return Math.hypot(one[0] - other[0], one[1] - other[1]);
}
