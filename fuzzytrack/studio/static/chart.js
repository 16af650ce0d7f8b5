/* A chart of lines over one axis: bands, bars and dots, a cursor that reads values, SVG throughout. */

import { html, svg } from "./elements.js";
import { colorClass, fillClass, lineStyle, pathOf, swatch } from "./lines.js";
import { shown, ticks } from "./numbers.js";

const MARGIN = { left: 62, right: 12, top: 10, bottom: 38 };
const HEADROOM = 1.05;
// Of more lines the bands are not read out, or the picture would be covered.
const MOST_RANGES = 2;
let charts = 0;

/**
 * Make a chart. `show(picture)` draws it: {name, x, y, series, limits, cursor, words}; x and y are
 * {label, low, high}, the ends optional; a series is {name, index, x, y, low, high, kind} where kind
 * is "line", "bars", "dots" or "steps"; `chosen(value)` hears of clicks on the picture.
 */
export function makeChart(chosen = null) {
  const picture = svg("svg", { class: "chart", role: "img", "aria-label": "nothing yet" });
  const readout = html("div", { class: "readout", hidden: true });
  const spoken = html("p", { class: "unseen", "aria-live": "polite" });
  const element = html(
    "div",
    {
      class: "chart-box",
      role: "group",
      tabindex: 0,
      onpointermove: (event) => point(event),
      onpointerleave: () => read(null),
      onclick: (event) => {
        const value = under(event);
        if (chosen && value !== null) chosen(value);
      },
      onkeydown: keys,
      onblur: () => read(null),
    },
    picture,
    readout,
    spoken,
  );
  const clip = `chart-clip-${(charts += 1)}`;
  let now = null;
  let place = null;
  let reading = null;

  function show(what) {
    now = what;
    reading = null;
    element.setAttribute("aria-label", `${what.name}: left and right arrow keys read the values`);
    draw();
  }

  function draw() {
    const { clientWidth: width, clientHeight: height } = element;
    if (!now || width < 40 || height < 40) return;
    const [x, y] = [axisOf(now, "x"), axisOf(now, "y")];
    const inner = {
      left: MARGIN.left,
      right: width - MARGIN.right,
      top: MARGIN.top,
      bottom: height - MARGIN.bottom,
    };
    place = {
      ...inner,
      x: (value) => inner.left + ((value - x.low) / (x.high - x.low)) * (inner.right - inner.left),
      y: (value) => inner.bottom - ((value - y.low) / (y.high - y.low)) * (inner.bottom - inner.top),
      value: (left) => x.low + ((left - inner.left) / (inner.right - inner.left)) * (x.high - x.low),
    };
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    picture.setAttribute("aria-label", now.words ?? described(now));
    const inside = svg("g", { "clip-path": `url(#${clip})` });
    inside.append(...(now.limits ?? []).flatMap((limit) => rule(place, limit)));
    inside.append(...now.series.flatMap((series) => areas(place, series)));
    inside.append(...now.series.flatMap((series) => strokes(place, series)));
    const box = {
      x: inner.left,
      y: inner.top,
      width: inner.right - inner.left,
      height: inner.bottom - inner.top,
    };
    picture.replaceChildren(
      svg("clipPath", { id: clip }, svg("rect", box)),
      ...frame(place, x, y, now, width, height),
      inside,
      ...cursorOf(place, now.cursor, "cursor"),
    );
    read(reading);
  }

  function under(event) {
    if (!place) return null;
    const left = event.clientX - element.getBoundingClientRect().left;
    return left < place.left - 4 || left > place.right + 4 ? null : place.value(left);
  }

  function point(event) {
    const value = under(event);
    read(value === null ? null : nearest(now, value));
  }

  function keys(event) {
    const known = now ? longest(now) : [];
    const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10 }[event.key];
    if (event.key === "Escape") read(null);
    if (!known.length || (step === undefined && !["Home", "End", "Enter"].includes(event.key))) return;
    event.preventDefault();
    if (event.key === "Enter") {
      if (chosen && reading !== null) chosen(reading);
      return;
    }
    const last = known.length - 1;
    const from = reading === null ? 0 : known.indexOf(reading);
    const to = { Home: 0, End: last }[event.key] ?? Math.max(0, Math.min(last, from + step));
    read(known[to]);
    spoken.textContent = readout.textContent;
  }

  /** Show the values at a place of the first axis, or none. */
  function read(value) {
    reading = value;
    picture.querySelector(".reading")?.remove();
    readout.hidden = value === null || !now || !place;
    if (readout.hidden) return;
    picture.append(...cursorOf(place, value, "reading"));
    const ranges = now.series.length <= MOST_RANGES;
    const rows = now.series.map((series) => rowOf(series, value, ranges)).filter(Boolean);
    readout.replaceChildren(
      html("div", { class: "at" }, withUnit(now.x.label, value)),
      ...rows,
    );
    // On the side of the cursor that has more room.
    const at = place.x(value);
    const room = element.clientWidth - readout.offsetWidth - 4;
    const left = at < element.clientWidth / 2 ? Math.min(at + 12, room) : at - readout.offsetWidth - 12;
    readout.style.left = `${Math.max(4, left)}px`;
    readout.style.top = `${place.top + 4}px`;
  }

  new ResizeObserver(draw).observe(element);
  return { element, picture, show };
}

/** A value of an axis, such as "time 60 s" of "time (s)". */
function withUnit(label, value) {
  const [, name, unit = ""] = label.match(/^(.*?)(?: \((.*?)\).*)?$/);
  return `${name} ${shown(value, 5)} ${unit}`.trim();
}

function axisOf(picture, key) {
  const { label, low, high } = picture[key];
  if (low !== undefined && high !== undefined && low < high) return { label, low, high };
  const values = picture.series.flatMap((series) =>
    key === "x" ? [series.x] : [series.y, series.low, series.high].filter(Boolean),
  );
  let [least, most] = [Infinity, -Infinity];
  for (const list of values) {
    for (const value of list) {
      if (value === null || !Number.isFinite(value)) continue;
      if (value < least) least = value;
      if (value > most) most = value;
    }
  }
  if (least > most) [least, most] = [0, 1];
  if (least === most) [least, most] = [least - 0.5, most + 0.5];
  if (key === "y") {
    const middle = (least + most) / 2;
    const half = ((most - least) / 2) * HEADROOM;
    [least, most] = [middle - half, middle + half];
  }
  return { label, low: low ?? least, high: high ?? most };
}

function frame(place, x, y, { x: { label: below }, y: { label: beside } }, width, height) {
  const parts = [];
  for (const value of ticks(x.low, x.high, (width - 60) / 70)) {
    const at = place.x(value);
    parts.push(svg("line", { class: "grid", x1: at, x2: at, y1: place.top, y2: place.bottom }));
    parts.push(
      svg("text", { class: "number", x: at, y: place.bottom + 15, "text-anchor": "middle" }, shown(value)),
    );
  }
  for (const value of ticks(y.low, y.high, (height - 40) / 34)) {
    const at = place.y(value);
    parts.push(svg("line", { class: "grid", x1: place.left, x2: place.right, y1: at, y2: at }));
    parts.push(
      svg("text", { class: "number", x: place.left - 6, y: at + 4, "text-anchor": "end" }, shown(value)),
    );
  }
  const middle = (place.left + place.right) / 2;
  const up = (place.top + place.bottom) / 2;
  parts.push(
    svg("line", { class: "base", x1: place.left, x2: place.right, y1: place.bottom, y2: place.bottom }),
    svg("text", { class: "axis", x: middle, y: height - 6, "text-anchor": "middle" }, below),
    svg(
      "text",
      { class: "axis", "text-anchor": "middle", transform: `translate(12 ${up}) rotate(-90)` },
      beside,
    ),
  );
  return parts;
}

function areas(place, { kind = "line", index, x, y, low, high }) {
  if (kind === "bars") return [svg("path", { class: fillClass(index), d: bars(place, x, y) })];
  if (!low || !high) return [];
  return stretches(low, high).map(([from, to]) => {
    const points = [];
    for (let k = from; k < to; k += 1) points.push([place.x(x[k]), place.y(high[k])]);
    for (let k = to - 1; k >= from; k -= 1) points.push([place.x(x[k]), place.y(low[k])]);
    return svg("path", { class: fillClass(index), d: `${pathOf(points)}Z` });
  });
}

/** Parts of two lists without a gap, as [from, to). */
function stretches(low, high) {
  const found = [];
  let from = null;
  for (let k = 0; k <= low.length; k += 1) {
    const known = k < low.length && Number.isFinite(low[k]) && Number.isFinite(high[k]);
    if (known && from === null) from = k;
    if (!known && from !== null) {
      found.push([from, k]);
      from = null;
    }
  }
  return found;
}

function strokes(place, { kind = "line", index, x, y }) {
  if (kind === "dots") {
    return x.flatMap((value, k) =>
      Number.isFinite(y[k])
        ? [svg("circle", { class: `dot ${colorClass(index)}`, cx: place.x(value), cy: place.y(y[k]), r: 2 })]
        : [],
    );
  }
  if (kind === "bars" || kind === "steps") {
    return [svg("path", { ...lineStyle(index), d: steps(place, x, y) })];
  }
  const points = thin(x, y, 2 * Math.max(100, place.right - place.left));
  const d = pathOf(points.map((k) => [place.x(x[k]), y[k] === null ? NaN : place.y(y[k])]));
  return [svg("path", { ...lineStyle(index), d })];
}

/** Numbers of the points to draw: of many, the least and the greatest of each short stretch. */
function thin(x, y, most) {
  if (x.length <= most) return x.map((_, k) => k);
  const width = Math.ceil((2 * x.length) / most);
  const kept = [];
  for (let from = 0; from < x.length; from += width) {
    let [low, high] = [from, from];
    for (let k = from; k < Math.min(from + width, x.length); k += 1) {
      if (y[k] < y[low]) low = k;
      if (y[k] > y[high]) high = k;
    }
    kept.push(Math.min(low, high));
    if (low !== high) kept.push(Math.max(low, high));
  }
  return kept;
}

// Of bars x are the edges, one more than y.
function steps(place, edges, heights) {
  const points = [];
  heights.forEach((height, k) => {
    points.push([place.x(edges[k]), place.y(height)], [place.x(edges[k + 1]), place.y(height)]);
  });
  return pathOf(points);
}

function bars(place, edges, heights) {
  const base = place.y(0);
  const [first, last] = [place.x(edges[0]), place.x(edges[heights.length])];
  return `M${first} ${base}${steps(place, edges, heights).replace("M", "L")}L${last} ${base}Z`;
}

function rule(place, { y, label }) {
  const at = place.y(y);
  return [
    svg("line", { class: "limit", x1: place.left, x2: place.right, y1: at, y2: at }),
    svg("text", { class: "number", x: place.right - 4, y: at - 4, "text-anchor": "end" }, label),
  ];
}

function cursorOf(place, value, name) {
  if (!Number.isFinite(value)) return [];
  const at = place.x(value);
  return [svg("line", { class: name, x1: at, x2: at, y1: place.top, y2: place.bottom })];
}

function longest({ series }) {
  return series.reduce((found, { x }) => (x.length > found.length ? x : found), []);
}

function nearest(picture, value) {
  const x = picture ? longest(picture) : [];
  return x.reduce(
    (best, each) => (best === null || Math.abs(each - value) < Math.abs(best - value) ? each : best),
    null,
  );
}

function rowOf({ name, index, x, y, low, high, kind }, value, ranges) {
  let at = x.indexOf(value);
  if (kind === "bars" || kind === "steps") at = Math.min(at, y.length - 1);
  const found = y[at];
  if (at < 0 || !Number.isFinite(found)) return null;
  const range =
    ranges && low && Number.isFinite(low[at]) ? ` (${shown(low[at], 3)} to ${shown(high[at], 3)})` : "";
  return html(
    "div",
    { class: "row" },
    swatch(index),
    html("span", {}, name),
    html("b", {}, ` ${shown(found, 4)}${range} `),
  );
}

function described({ name, series }) {
  const parts = series.map(({ name: line, y }) => {
    const known = y.filter((value) => Number.isFinite(value));
    if (!known.length) return `${line}: no values`;
    return `${line}: from ${shown(Math.min(...known), 3)} to ${shown(Math.max(...known), 3)}`;
  });
  return `${name}. ${parts.join("; ")}`;
}
