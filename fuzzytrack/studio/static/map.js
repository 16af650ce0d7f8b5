/* A map in meters with one scale for both axes: zoom, pan, coordinates, a scale bar, distances. */

import { html, svg } from "./elements.js";
import { icon } from "./icons.js";
import { shown, ticks } from "./numbers.js";

const ZOOM = 1.25;
const BORDER = 28;
const BAR_PIXELS = 120;
const NEAREST = 1e-3; // meters a pixel
const FARTHEST = 1e6;
// Pixels of an arrow key: of the map, and of the cross.
const PAN = 40;
const AIM = 5;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/**
 * Make a map. Layers are {element, draw(place)}; place has x(east), y(north) in pixels and `scale`,
 * meters a pixel. `clicked({x, y})` hears of clicks on the ground in meters, while `drawing()`. While
 * it is drawn or measured, the arrow keys move a cross, and the space key is a click there.
 */
export function makeMap({ name, bounds, clicked = null, drawing = () => false }) {
  const ground = svg("g", { class: "map-grid" });
  const content = svg("g", {});
  const over = svg("g", { class: "map-over", "aria-hidden": "true" });
  const picture = svg("svg", { class: "map", "aria-label": name, role: "group", tabindex: 0 });
  picture.append(ground, content, over);
  const coordinates = html("output", { class: "coordinates", "aria-label": "Under the pointer" });
  const measure = html(
    "button",
    {
      type: "button",
      class: "quiet",
      "aria-pressed": "false",
      title: "Measure the distance and direction between two places: drag; or arrows and Space",
      onclick: () => setMeasuring(!measuring),
    },
    "Measure",
  );
  const tools = html(
    "div",
    { class: "map-tools", role: "group", "aria-label": "Zoom of the map" },
    button("Zoom in (+)", "+", () => zoom(1 / ZOOM)),
    button("Zoom out (−)", "−", () => zoom(ZOOM)),
    button("Show the whole track (0)", icon("home"), () => fit()),
    measure,
  );
  const element = html("div", { class: "map-box" }, picture, tools, coordinates);
  const layers = [];
  const touches = new Map();
  let center = [0, 0];
  let scale = null;
  let asked = false;
  let measuring = false;
  let ruler = null;
  let ruling = false;
  let moved = false;
  // The cross of the keys, in meters.
  let aim = null;

  const place = {
    x: (east) => inPicture(picture.clientWidth / 2 + (east - center[0]) / scale),
    y: (north) => inPicture(picture.clientHeight / 2 - (north - center[1]) / scale),
    get scale() {
      return scale;
    },
  };

  function button(title, face, run) {
    return html("button", { type: "button", class: "quiet", title, "aria-label": title, onclick: run }, face);
  }

  function setMeasuring(on) {
    measuring = on;
    ruler = null;
    ruling = false;
    aim = null;
    measure.setAttribute("aria-pressed", String(on));
    if (on) picture.focus();
    redraw();
  }

  function toWorld(event) {
    const box = picture.getBoundingClientRect();
    const [left, top] = [event.clientX - box.left, event.clientY - box.top];
    return {
      x: center[0] + (left - box.width / 2) * scale,
      y: center[1] - (top - box.height / 2) * scale,
    };
  }

  function add(layer) {
    layers.push(layer);
    content.append(layer.element);
    redraw();
  }

  /** Draw at the next frame. */
  function redraw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const { clientWidth: width, clientHeight: height } = picture;
      if (!width || !height) return;
      if (scale === null) setScale();
      picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
      ground.replaceChildren(...grid(place, center, width, height));
      for (const layer of layers) layer.draw(place);
      if (!isAiming()) aim = null;
      over.replaceChildren(...scaleBar(scale, width, height), ...rulerOf(place, ruler), ...crossOf(place, aim));
    });
  }

  function setScale() {
    const [west, south, east, north] = bounds() ?? [-1000, -1000, 1000, 1000];
    // The buttons lie over the top of the map.
    const top = tools.offsetHeight;
    const [width, height] = [picture.clientWidth, picture.clientHeight - top].map((v) =>
      Math.max(40, v - 2 * BORDER),
    );
    const least = 1e-3 * Math.max(1, Math.abs(east), Math.abs(north));
    scale = Math.max(Math.max(east - west, least) / width, Math.max(north - south, least) / height);
    center = [(west + east) / 2, (south + north + scale * top) / 2];
  }

  /** Show all there is. */
  function fit() {
    scale = null;
    redraw();
  }

  function zoom(factor, at = { x: center[0], y: center[1] }) {
    const next = Math.max(NEAREST, Math.min(FARTHEST, scale * factor));
    const share = next / scale;
    center = [at.x + (center[0] - at.x) * share, at.y + (center[1] - at.y) * share];
    scale = next;
    redraw();
  }

  function pan(right, down) {
    center = [center[0] - right * scale, center[1] + down * scale];
    redraw();
  }

  function press(event) {
    if (event.button !== 0 || event.target.closest("[data-handle]")) return;
    picture.setPointerCapture(event.pointerId);
    touches.set(event.pointerId, event);
    moved = false;
    if (measuring) ruler = { from: toWorld(event), to: toWorld(event) };
  }

  function move(event) {
    if (scale === null) return;
    const under = toWorld(event);
    if (aim) {
      aim = null;
      redraw();
    }
    tell(under);
    const before = touches.get(event.pointerId);
    if (!before) return;
    const others = [...touches.values()].filter((each) => each.pointerId !== event.pointerId);
    const [right, down] = [event.clientX - before.clientX, event.clientY - before.clientY];
    if (!moved && Math.hypot(right, down) < 4) return;
    moved = true;
    touches.set(event.pointerId, event);
    if (measuring) {
      ruler.to = under;
      redraw();
    } else if (others.length) {
      zoom(apart(before, others[0]) / Math.max(1, apart(event, others[0])), under);
    } else pan(right, down);
  }

  function release(event) {
    if (!touches.delete(event.pointerId)) return;
    if (!moved && clicked && drawing() && !measuring) clicked(toWorld(event));
  }

  function tell({ x, y }) {
    const digits = Math.max(0, Math.ceil(-Math.log10(scale)));
    const words = [x, y].map((v) => v.toFixed(digits).replace("-", "−"));
    const measured = ruling ? `   ${lengthOf(ruler)}` : "";
    coordinates.value = `x ${words[0]} m   y ${words[1]} m${measured}`;
  }

  function isAiming() {
    return measuring || Boolean(clicked && drawing());
  }

  /** Move the cross, and the map with it at its edges. */
  function aimBy([right, down], far) {
    const from = aim ?? { x: center[0], y: center[1] };
    aim = { x: from.x + right * far * AIM * scale, y: from.y - down * far * AIM * scale };
    const [left, top] = [place.x(aim.x), place.y(aim.y)];
    pan(Math.min(0, picture.clientWidth - 20 - left) + Math.max(0, 20 - left),
      Math.min(0, picture.clientHeight - 20 - top) + Math.max(0, 20 - top));
    if (ruling) ruler.to = aim;
    tell(aim);
  }

  /** The space key: a click at the cross, or an end of the ruler. */
  function putAtCross() {
    if (!aim) return aimBy([0, 0], 0);
    if (!measuring) return clicked(aim);
    ruling = !ruling;
    ruler = ruling ? { from: aim, to: aim } : ruler;
    redraw();
  }

  function keys(event) {
    if (event.target !== picture || event.ctrlKey || event.metaKey || event.altKey) return;
    const [right, down] = ARROWS[event.key] ?? [];
    const arrow = isAiming()
      ? () => aimBy([right, down], event.shiftKey ? 10 : 1)
      : () => pan(-PAN * right, -PAN * down);
    const done = {
      ...(ARROWS[event.key] ? { [event.key]: arrow } : {}),
      ...(isAiming() ? { " ": putAtCross } : {}),
      ...(measuring ? { Escape: () => setMeasuring(false) } : {}),
      "+": () => zoom(1 / ZOOM),
      "=": () => zoom(1 / ZOOM),
      "-": () => zoom(ZOOM),
      0: fit,
      Home: fit,
    }[event.key];
    if (!done) return;
    event.preventDefault();
    done();
  }

  picture.addEventListener("pointerdown", press);
  picture.addEventListener("pointermove", move);
  picture.addEventListener("pointerup", release);
  picture.addEventListener("pointercancel", (event) => touches.delete(event.pointerId));
  picture.addEventListener("keydown", keys);
  picture.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      if (scale !== null) zoom(event.deltaY > 0 ? ZOOM ** 0.5 : ZOOM ** -0.5, toWorld(event));
    },
    { passive: false },
  );
  new ResizeObserver(redraw).observe(picture);
  return { element, picture, tools, add, redraw, fit, toWorld, place };
}

/** Limits of lists of points as [west, south, east, north]; null without any. */
export function boundsOf(points) {
  let found = null;
  for (const [x, y] of points) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
    found ??= [x, y, x, y];
    if (x < found[0]) found[0] = x;
    if (y < found[1]) found[1] = y;
    if (x > found[2]) found[2] = x;
    if (y > found[3]) found[3] = y;
  }
  return found;
}

// Pixels from which on all is as far away: larger numbers are none in a picture.
const AWAY = 1e6;

function inPicture(pixels) {
  return Math.max(-AWAY, Math.min(AWAY, pixels));
}

// From here on distances are in km, which is shorter.
const FAR = 1e4;

/** A distance in words, in m or km; `largest` is that of those beside it, in the same unit. */
export function distance(meters, largest = Math.abs(meters)) {
  return largest >= FAR ? `${shown(meters / 1000, 4)} km` : `${shown(meters, 4)} m`;
}

function apart(one, other) {
  return Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
}

function grid(place, center, width, height) {
  const parts = [];
  const half = { x: (width / 2) * place.scale, y: (height / 2) * place.scale };
  const count = width / 110;
  const step = spacing(ticks(0, 2 * half.x, count));
  const largest = Math.max(Math.abs(center[0]) + half.x, Math.abs(center[1]) + half.y);
  const label = (value) => distance(value, largest);
  for (const value of multiples(center[0] - half.x, center[0] + half.x, step)) {
    const at = place.x(value);
    parts.push(svg("line", { class: "grid", x1: at, x2: at, y1: 0, y2: height }));
    // A label is up to 48 px wide, and one that does not fit is left out.
    if (at > 60 && at < width - 48)
      parts.push(svg("text", { class: "number", x: at + 3, y: height - 5 }, label(value)));
  }
  for (const value of multiples(center[1] - half.y, center[1] + half.y, step)) {
    const at = place.y(value);
    parts.push(svg("line", { class: "grid", x1: 0, x2: width, y1: at, y2: at }));
    // The corners belong to the coordinates and to the labels below.
    if (at > 36 && at < height - 24)
      parts.push(svg("text", { class: "number", x: 4, y: at - 3 }, label(value)));
  }
  return parts;
}

function spacing(values) {
  return values.length > 1 ? values[1] - values[0] : 1;
}

function multiples(low, high, step) {
  const first = Math.ceil(low / step);
  const last = Math.floor(high / step);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => (first + k) * step);
}

function scaleBar(scale, width, height) {
  const most = BAR_PIXELS * scale;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((m) => m * power).find((v) => v <= most);
  const [right, at] = [width - 12, height - 24];
  const left = right - length / scale;
  return [
    svg("path", { class: "scale", d: `M${left} ${at - 5}v5H${right}v-5` }),
    svg(
      "text",
      { class: "axis", x: (left + right) / 2, y: at - 8, "text-anchor": "middle" },
      distance(length),
    ),
  ];
}

function rulerOf(place, ruler) {
  if (!ruler) return [];
  const { from, to } = ruler;
  const [x1, y1, x2, y2] = [place.x(from.x), place.y(from.y), place.x(to.x), place.y(to.y)];
  return [
    svg("line", { class: "ruler", x1, y1, x2, y2 }),
    svg("text", { class: "ruler-text", x: x2 + 8, y: y2 - 8 }, lengthOf(ruler)),
  ];
}

/** Distance and direction of a ruler in words; directions are from the x axis toward the y axis. */
function lengthOf({ from, to }) {
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  const heading = (Math.atan2(to.y - from.y, to.x - from.x) * 180) / Math.PI;
  return `${distance(length)}, ${shown(heading, 3)}°`;
}

function crossOf(place, aim) {
  if (!aim) return [];
  const [x, y] = [place.x(aim.x), place.y(aim.y)];
  return [svg("path", { class: "aim", d: `M${x - 12} ${y}h24M${x} ${y - 12}v24` })];
}
