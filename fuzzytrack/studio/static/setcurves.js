/* Curves of the sets of a variable: their axes, names and lines, as parts of an SVG. */

import { svg } from "./elements.js";
import { shown, ticks } from "./numbers.js";
import { shapeOf } from "./shapes.js";

const MARGIN = { left: 30, right: 14, top: 34, bottom: 36 };

/** Where values and grades are in the picture. */
export function scaleOf(picture, { universe: [low, high] }) {
  const { clientWidth: width, clientHeight: height } = picture;
  const [wide, tall] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
  return {
    width,
    height,
    low,
    high,
    x: (value) => MARGIN.left + ((value - low) / (high - low)) * wide,
    y: (grade) => MARGIN.top + (1 - grade) * tall,
    value: (pixels) => low + ((pixels - MARGIN.left) / wide) * (high - low),
    pixel: (high - low) / wide,
  };
}

export function clamp(value, { low, high }) {
  return Math.max(low, Math.min(high, value));
}

export function axis(at, { name, label }) {
  const bottom = at.y(0);
  const words = label === name ? name : `${name}: ${label}`;
  const parts = [0, 0.5, 1].flatMap((grade) => [
    svg("line", { class: "grid", x1: at.x(at.low), x2: at.x(at.high), y1: at.y(grade), y2: at.y(grade) }),
    svg("text", { class: "number", x: MARGIN.left - 6, y: at.y(grade) + 4, "text-anchor": "end" }, shown(grade)),
  ]);
  for (const value of ticks(at.low, at.high, at.width / 60)) {
    const x = at.x(value);
    parts.push(svg("line", { class: "tick", x1: x, x2: x, y1: bottom, y2: bottom + 4 }));
    parts.push(svg("text", { class: "number", x, y: bottom + 15, "text-anchor": "middle" }, shown(value)));
  }
  const middle = (at.x(at.low) + at.x(at.high)) / 2;
  parts.push(svg("text", { class: "axis", x: middle, y: at.height - 4, "text-anchor": "middle" }, words));
  return parts;
}

export function curve(at, one, stroke, chosen) {
  const { grade, corners } = shapeOf(one);
  const even = Array.from({ length: 161 }, (_, k) => at.low + ((at.high - at.low) * k) / 160);
  const exact = corners.map((corner) => corner.place(one.parameters)).filter((x) => x >= at.low && x <= at.high);
  // Beside a corner too, where a vertical flank jumps.
  const beside = exact.flatMap((x) => [x - 1e-9 * (at.high - at.low), x, x + 1e-9 * (at.high - at.low)]);
  const places = [...even, ...beside].filter((x) => x >= at.low && x <= at.high).sort((a, b) => a - b);
  if (Number.isNaN(grade(at.low, one.parameters))) return svg("g");
  const points = places.map((x) => `${at.x(x).toFixed(1)},${at.y(grade(x, one.parameters)).toFixed(1)}`);
  const line = svg("polyline", { class: chosen ? "curve chosen" : "curve", points: points.join(" "), stroke });
  if (!chosen) return line;
  const foot = `${at.x(at.low)},${at.y(0)} ${points.join(" ")} ${at.x(at.high)},${at.y(0)}`;
  return svg("g", {}, svg("polygon", { class: "inside", points: foot, fill: stroke }), line);
}

/** Names over the peaks, in two rows where they would touch; one that fits in neither is left out. */
export function labels(at, sets, chosen, paint) {
  const taken = [[], []];
  const places = sets.map((one) => {
    const [, b, c] = shapeOf(one).quad(one.parameters);
    return { name: one.name, x: (at.x(clamp(b, at)) + at.x(clamp(c, at))) / 2 };
  });
  return places
    .filter(({ x }) => Number.isFinite(x))
    .sort((a, b) => (b.name === chosen) - (a.name === chosen) || a.x - b.x)
    .flatMap(({ name, x }) => {
      const half = 4 * name.length + 3;
      const row = taken.findIndex((others) => others.every((one) => Math.abs(one.x - x) > one.half + half));
      if (row < 0) return [];
      taken[row].push({ x, half });
      const middle = Math.max(half, Math.min(at.width - half, x));
      return svg(
        "text",
        {
          class: name === chosen ? "name chosen" : "name",
          x: middle,
          y: MARGIN.top - 7 - 13 * row,
          "text-anchor": "middle",
          fill: paint(name),
        },
        name,
      );
    });
}

/** The explained value of the variable, as a line through its sets. */
export function explained(at, { name }, explanation) {
  const value = explanation?.inputs[name] ?? explanation?.outputs[name];
  if (!Number.isFinite(value)) return [];
  const x = at.x(clamp(value, at));
  return [svg("line", { class: "explained", x1: x, x2: x, y1: at.y(1.04), y2: at.y(0) })];
}
