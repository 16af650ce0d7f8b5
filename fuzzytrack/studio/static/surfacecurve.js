/* A surface over a single input, which is a curve. */

import { axisOf, drawAxes } from "./axes.js";
import { token } from "./colors.js";
import { nameOf, rangeOf, spotOf } from "./surfacevalues.js";

function curveBox(width, height) {
  return { left: 58, top: 20, width: width - 80, height: height - 64 };
}

/** Draw the values over one input, and the explained point. */
export function drawCurve(pen, width, height, values, point) {
  const [low, high] = rangeOf(values);
  const margin = 0.05 * (high - low);
  const box = curveBox(width, height);
  const label = nameOf(values);
  const axis = axisOf(values.axes[0]);
  const place = drawAxes(pen, box, axis, { low: low - margin, high: high + margin, label, name: label });
  const line = [];
  values.heights.forEach((value, k) => {
    const x = axis.low + (k / (values.columns - 1)) * (axis.high - axis.low);
    if (!Number.isNaN(value)) line.push(place.x(x), place.y(value));
  });
  if (line.length) pen.line(line, token("--accent"), 2);
  const spot = point && spotOf(values, point);
  if (spot) {
    const x = place.x(point[axis.name]);
    pen.line([x, box.top, x, box.top + box.height], token("--pin"), 1, [3, 3]);
    pen.circle(x, place.y(spot.height), 5, token("--pin"), token("--halo"), 2);
  }
}

/** The value of the input under a place of the screen. */
export function onCurve([left], [width, height], { axes }) {
  const box = curveBox(width, height);
  const [low, high] = axes[0].universe;
  const share = Math.max(0, Math.min(1, (left - box.left) / box.width));
  return [low + share * (high - low)];
}
