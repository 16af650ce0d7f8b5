/* The form of the target: a maneuver with its numbers, or way-points with their pace. */

import { choice, html, select } from "./elements.js";
import { group, numberField } from "./fields.js";
import { tidy } from "./numbers.js";
import { targetKind, truthOf } from "./scenario.js";
import { waypointList } from "./waypoints.js";

// Maneuvers of Llinas et al. (1998), section 4.1, and the numbers that each takes.
const MANEUVERS = [
  ["constant-velocity", "straight, constant speed"],
  ["constant-acceleration", "straight, speeding up"],
  ["turn", "turn, constant speed"],
  ["turn-with-angular-acceleration", "turn, speeding up"],
  ["waypoints", "through way-points"],
];
const TAKES = {
  "constant-velocity": ["speed", "heading", "steps", "period"],
  "constant-acceleration": ["speed", "acceleration", "heading", "steps", "period"],
  turn: ["speed", "radius", "heading", "steps", "period"],
  "turn-with-angular-acceleration": ["speed", "acceleration", "radius", "heading", "steps", "period"],
};
// Numbers of a maneuver that is new; those of the shipped scenarios.
const BEGIN = { speed: 6, acceleration: 0.004, radius: 4500, heading: 30, steps: 20, period: 60 };
const FIELDS = {
  speed: ["Speed", "m/s", "Speed at the start"],
  acceleration: ["Acceleration", "m/s²", "Along the path"],
  radius: ["Turn radius", "m", "Negative for a turn to the right"],
  heading: ["Heading", "°", "From the x axis toward the y axis"],
  steps: ["Scans", "", "Number of scans"],
  period: ["Period", "s", "Time from one scan to the next"],
};
// Way-points that stand for another track when it becomes one through way-points.
const KEPT = 6;

/** The form; `points()` are the way-points on screen, `writePoints(points)` changes them. */
export function targetForm({ store, scenario }, points, writePoints) {
  const kind = select("Maneuver", [], "", setKind);
  // The speed along the way-points as it was set: the times in the text are rounded, and from edit to
  // edit the speed would drift.
  let speedSet = null;
  const list = waypointList(writePoints);
  const pace = choice("Pace along the way-points", setPace);
  const positive = { least: 1e-6 };
  const speed = numberField("Speed", "m/s", setSpeed, positive);
  const leg = numberField("Time a leg", "s", (value) => setPoints({ leg: value }), positive);
  const period = numberField("Period", "s", (value) => setPoints({ period: value, ...timing() }), {
    ...positive,
    title: FIELDS.period[2],
  });
  const byPoints = html(
    "div",
    { class: "form-grid" },
    html("div", { class: "field wide" }, html("span", { class: "label" }, "Pace"), pace.element),
    speed.element,
    leg.element,
    period.element,
  );
  const numbers = Object.fromEntries(
    Object.entries(FIELDS).map(([key, [label, unit, help]]) => [
      key,
      numberField(label, unit, (value) => setMotion(store.now.scenario.target.motion, { [key]: value }), {
        whole: key === "steps",
        title: help,
      }),
    ]),
  );
  const place = ["x", "y"].map((axis, k) =>
    numberField(`Start ${axis}`, "m", (value) =>
      setStart(start()[0].map((old, which) => (which === k ? value : old))),
    ),
  );
  const byMotion = html(
    "div",
    { class: "form-grid" },
    [...Object.values(numbers), ...place].map((field) => field.element),
  );
  const note = html("p", { class: "note" });
  const element = group(
    "Target",
    html("label", { class: "field" }, html("span", { class: "label" }, "Maneuver"), kind),
    note,
    byMotion,
    byPoints,
    list.element,
  );

  function setMotion(motion, change = {}) {
    const { target } = store.now.scenario;
    const kept = TAKES[motion].map((key) => [
      key,
      typeof target?.[key] === "number" ? target[key] : BEGIN[key],
    ]);
    scenario.change("set_motion", { motion, ...Object.fromEntries(kept), ...change });
  }

  /** Where a maneuver begins, as a list of one point; empty if the target is something else. */
  function start() {
    const now = store.now.scenario;
    return now && targetKind(now) === "motion" ? [now.target.start ?? [0, 0]] : [];
  }

  function setStart(point) {
    const { motion } = store.now.scenario.target;
    return scenario.change("set_motion", { motion, start: point });
  }

  function setKind(value) {
    if (value === "waypoints") writePoints(pointsOf(store.now.scenario));
    else if (TAKES[value]) {
      // A new maneuver begins where the target did.
      setMotion(value, start().length ? {} : { start: pointsOf(store.now.scenario)[0] });
    }
  }

  function setPoints(change) {
    scenario.change("set_waypoints", { points: points(), ...change });
  }

  function setSpeed(value) {
    speedSet = value;
    setPoints({ speed: value });
  }

  function setPace(value) {
    if (value === "speed") setSpeed(meanSpeed(store.now.scenario));
    else setPoints({ leg: meanLeg(store.now.scenario) });
  }

  function speedNow(now) {
    const mean = meanSpeed(now);
    if (speedSet === null || Math.abs(mean / speedSet - 1) > 0.01) speedSet = mean;
    return speedSet;
  }

  /** How way-points are paced when they change: as they were. */
  function timing() {
    const now = store.now.scenario;
    // A track that becomes one through way-points keeps its mean speed.
    if (targetKind(now) !== "waypoints") {
      speedSet = Number((lengthOf(truthOf(now)) / durationOf(now)).toPrecision(3));
      return { speed: speedSet };
    }
    return now.target.times ? { speed: speedNow(now) } : { leg: meanLeg(now) };
  }

  function show() {
    const now = store.now.scenario;
    if (!now) return;
    const what = targetKind(now);
    const editable = what === "waypoints" || what === "motion";
    showKinds(now, what, editable);
    note.hidden = editable;
    note.textContent = "Its numbers are those of its source. Choose another maneuver to set them.";
    byPoints.hidden = what !== "waypoints";
    list.element.hidden = !points().length;
    byMotion.hidden = what !== "motion";
    if (what === "motion") {
      for (const [key, field] of Object.entries(numbers)) {
        field.element.hidden = !TAKES[now.target.motion]?.includes(key);
        field.show(now.target[key]);
      }
      place.forEach((field, k) => field.show(start()[0][k]));
    }
    if (what === "waypoints") showPace(now);
    list.show(points());
  }

  function showKinds(now, what, editable) {
    const options = editable ? MANEUVERS : [[what, nameOf(now)], ...MANEUVERS];
    const wanted = options.join();
    if (kind.dataset.options !== wanted) {
      kind.dataset.options = wanted;
      kind.replaceChildren(...options.map(([key, text]) => html("option", { value: key }, text)));
    }
    kind.value = what === "motion" ? now.target.motion : what;
  }

  function showPace(now) {
    const bySpeed = Boolean(now.target.times);
    pace.show(
      [
        ["leg", "same time a leg", "Each leg takes as long as the others"],
        ["speed", "same speed", "Each leg takes the time that it would at this speed if it were straight"],
      ],
      bySpeed ? "speed" : "leg",
    );
    speed.element.hidden = !bySpeed;
    leg.element.hidden = bySpeed;
    speed.show(speedNow(now));
    leg.show(meanLeg(now));
    const [begin, next] = now.scenario.time;
    period.show(now.target.period ?? next - begin);
  }

  return { element, show, start, setStart, timing };
}

function nameOf({ target, name }) {
  return target?.maneuver ? `${target.maneuver} of its source` : `as in ${name}`;
}

/** Way-points in the place of the track that is there. */
function pointsOf(now) {
  const all = truthOf(now);
  const count = Math.min(KEPT, all.length);
  // To about a thousandth of the path.
  const step = 10 ** Math.floor(Math.log10(Math.max(1e-3, lengthOf(all)) / 1000));
  return Array.from({ length: count }, (_, k) =>
    all[Math.round((k * (all.length - 1)) / (count - 1))].map((value) =>
      tidy(Math.round(value / step) * step),
    ),
  );
}

function durationOf({ scenario: { time } }) {
  return time.at(-1) - time[0];
}

function meanLeg(now) {
  const { leg, waypoints } = now.target;
  return leg ?? Number((durationOf(now) / (waypoints.length - 1)).toPrecision(6));
}

function meanSpeed(now) {
  const { times, waypoints } = now.target;
  const total = times ? times.at(-1) - times[0] : durationOf(now);
  return Number((lengthOf(waypoints) / total).toPrecision(4));
}

/** Length of straight legs through points, m. */
function lengthOf(points) {
  return points.slice(1).reduce((sum, [x, y], k) => sum + Math.hypot(x - points[k][0], y - points[k][1]), 0);
}
