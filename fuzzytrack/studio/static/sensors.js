/* The sensors of the scenario: their places and reaches on the map, and their numbers. */

import { choice, html, select, svg } from "./elements.js";
import { group, numberField } from "./fields.js";

const SPACINGS = [
  ["dense", "dense, 2 km"],
  ["medium", "medium, 5 km"],
  ["sparse", "sparse, 10 km"],
];
// The field of Llinas et al. (1998), section 5.2 (variances of 200 m² and 3π/180 rad²), and the plain
// noise of the shipped scenarios. The field is moved aside: a target that starts at 0, 0, or goes
// through round numbers, is never exactly at a sensor, where its plot would have no variance.
const FIELD = {
  grid: 7,
  spacing: "dense",
  reach: 1000,
  range_sigma: 14.14,
  bearing_sigma: 13.11,
  centre: [250, 250],
};
const FREE = { sigma: 115 };
// As many circles are drawn one by one; of more only the places.
const MOST_REACHES = 2500;

/** The layer of the map; `read()` gives the scenario. */
export function sensorLayer(read) {
  const reaches = svg("path", { class: "sensor-reach" });
  const places = svg("path", { class: "sensor" });
  const element = svg("g", {}, reaches, places);

  function draw(place) {
    const field = read()?.scenario?.sensors;
    const known = field?.kind === "field" ? field.positions : [];
    const shown = known.map(([x, y], k) => [place.x(x), place.y(y), radius(field, k) / place.scale]);
    places.setAttribute("d", shown.map(([x, y]) => circle(x, y, 2.5)).join(""));
    const drawn = shown.length <= MOST_REACHES ? shown : [];
    reaches.setAttribute("d", drawn.map(([x, y, r]) => circle(x, y, r)).join(""));
  }

  return { element, draw };
}

/** Range of sensor number `k`, m; a field has one for all, or one for each. */
export function radius({ reach }, k) {
  return Array.isArray(reach) ? reach[k] : reach;
}

function circle(x, y, r) {
  return `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
}

/** The form of the sensors. */
export function sensorForm({ store, scenario }) {
  const kind = choice("Sensors", setKind);
  const spacing = select("Spacing", [], "", (value) =>
    send({ spacing: SPACINGS.some(([k]) => k === value) ? value : Number(value) }),
  );
  const number = (label, unit, key, options) =>
    numberField(label, unit, (value) => send({ [key]: value }), { least: 0, ...options });
  const shared = number("Detection", "", "detection", {
    title: "Probability of a plot in a scan, above 0 and up to 1",
  });
  const ofField = {
    grid: number("Grid", "n × n", "grid", { least: 1, whole: true }),
    reach: number("Reach", "m", "reach", { title: "Largest range at which a sensor sees the target" }),
    range_sigma: number("Range σ", "m", "range_sigma", { title: "Standard deviation of range" }),
    bearing_sigma: number("Bearing σ", "°", "bearing_sigma", { title: "Standard deviation of bearing" }),
  };
  const ofFree = {
    sigma: number("Plot σ", "m", "sigma", { title: "Standard deviation of a plot on each axis" }),
  };
  const own = numberField("Distance", "m", (value) => send({ spacing: value }), { least: 1e-3 });
  const grid = html(
    "div",
    { class: "form-grid" },
    html("label", { class: "field" }, html("span", { class: "label" }, "Spacing"), spacing),
    own.element,
    ...Object.values(ofField).map((field) => field.element),
  );
  const fields = html("div", { class: "form-grid" }, ofFree.sigma.element, shared.element);
  const note = html("p", { class: "note" });
  const element = group("Sensors", kind.element, note, grid, fields);

  function send(change) {
    scenario.change("set_sensors", change);
  }

  function setKind(value) {
    send(value === "field" ? FIELD : FREE);
  }

  function show() {
    const now = store.now.scenario;
    if (!now) return;
    const { sensors } = now.scenario;
    const entries = now.sensors ?? {};
    const isField = sensors.kind === "field";
    kind.show(
      [
        ["noise", "free", "A plot at every place, with the same noise"],
        ["field", "sensor field", "A grid of sensors with a reach"],
      ],
      sensors.kind,
    );
    grid.hidden = !isField;
    fields.hidden = sensors.kind === "other";
    ofFree.sigma.element.hidden = isField;
    note.hidden = sensors.kind !== "other";
    note.textContent = "These sensors cannot be changed here. Choose free, or a sensor field.";
    if (isField) showSpacing(entries.spacing);
    for (const [key, field] of Object.entries({ ...ofField, ...ofFree })) {
      const value = entries[key] ?? sensors[key];
      field.show(typeof value === "number" ? value : null);
    }
    shared.show(typeof sensors.detection === "number" ? sensors.detection : null);
  }

  function showSpacing(value) {
    const word = SPACINGS.some(([key]) => key === value);
    const meters = typeof value === "number" ? value : 4000;
    spacing.replaceChildren(
      ...[...SPACINGS, [String(meters), "another"]].map(([key, text]) =>
        html("option", { value: key }, text),
      ),
    );
    spacing.value = word ? value : String(meters);
    own.element.hidden = word;
    own.show(word ? null : meters);
  }

  return { element, show };
}
