/* How the lines of trackers look: a color each, then dashes, the same in every picture. */

import { html, svg } from "./elements.js";

export const COLORS = 6;
const DASHES = [null, "6 3", "2 2.5"];

/** Class of the color of tracker number `index`; that of the truth and of plots is -1. */
export function colorClass(index) {
  return index < 0 ? "reference" : `c${index % COLORS}`;
}

/** Attributes of the line of a tracker. */
export function lineStyle(index) {
  return {
    class: `line ${colorClass(index)}`,
    "stroke-dasharray": DASHES[Math.floor(Math.max(0, index) / COLORS) % DASHES.length],
  };
}

/** Class of what is filled in the color of a tracker. */
export function fillClass(index) {
  return `area ${colorClass(index)}`;
}

/** A piece of the line of a tracker, for tables and legends. */
export function swatch(index) {
  return svg(
    "svg",
    { class: "line-swatch", width: 22, height: 10, viewBox: "0 0 22 10", "aria-hidden": "true" },
    svg("line", { ...lineStyle(index), x1: 1, x2: 21, y1: 5, y2: 5 }),
  );
}

/** What the lines of a picture are, for its heading: [[name, index], ...]. */
export function keyOf(lines) {
  return html(
    "span",
    { class: "line-key" },
    lines.map(([name, index]) => html("span", {}, swatch(index), name)),
  );
}

/** SVG path of points; a new stroke begins where one is not finite. */
export function pathOf(points) {
  const words = [];
  let pen = "M";
  for (const [x, y] of points) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) {
      pen = "M";
      continue;
    }
    words.push(`${pen}${x.toFixed(1)} ${y.toFixed(1)}`);
    pen = "L";
  }
  return words.join("");
}
