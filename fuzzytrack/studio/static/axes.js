/* Axes in the plane and the color bar, for the pictures drawn with pens. */

import { color, css, token } from "./colors.js";
import { shown, ticks } from "./numbers.js";

const BAR = 10;

/**
 * Draw a frame with ticks around `box` ({left, top, width, height}); x and y are
 * {low, high, label}. Gives the functions from values to places.
 */
export function drawAxes(pen, box, x, y) {
  const { left, top, width, height } = box;
  const place = {
    x: (value) => left + ((value - x.low) / (x.high - x.low)) * width,
    y: (value) => top + height - ((value - y.low) / (y.high - y.low)) * height,
  };
  const [line, muted, ink] = ["--edge", "--muted", "--ink"].map(token);
  pen.polygon(corners(box), null, line, 1);
  for (const value of ticks(x.low, x.high, width / 60)) {
    pen.line([place.x(value), top + height, place.x(value), top + height + 4], line);
    pen.text(place.x(value), top + height + 12, shown(value), { fill: muted, align: "middle" });
  }
  for (const value of ticks(y.low, y.high, height / 44)) {
    pen.line([left - 4, place.y(value), left, place.y(value)], line);
    pen.text(left - 7, place.y(value), shown(value), { fill: muted, align: "end" });
  }
  const words = { fill: ink, align: "middle", size: 12 };
  pen.text(left + width / 2, top + height + 28, fitting(x, width), words);
  pen.text(left - 40, top + height / 2, fitting(y, height), { ...words, turn: -90 });
  return place;
}

/** Draw the scale of colors at the right edge, from `top` down, with the ends of the range. */
export function drawColorBar(pen, { left, top, height }, palette, [low, high], title) {
  const [muted, ink] = ["--muted", "--ink"].map(token);
  const steps = Math.min(64, Math.round(height / 2));
  const place = (value) => top + height - ((value - low) / (high - low)) * height;
  for (let k = 0; k < steps; k += 1) {
    const [from, to] = [k, k + 1].map((at) => top + height - (at / steps) * height);
    const fill = css(color(palette, (k + 0.5) / steps));
    // A little overlap, or the ground would shine through between the steps.
    const above = Math.max(top, to - 0.6);
    pen.polygon([left, from, left + BAR, from, left + BAR, above, left, above], fill);
  }
  for (const value of ticks(low, high, Math.max(2, height / 40))) {
    pen.line([left + BAR, place(value), left + BAR + 3, place(value)], muted);
    pen.text(left + BAR + 6, place(value), shown(value), { fill: muted });
  }
  pen.text(left + BAR, top - 12, title, { fill: ink, align: "middle", size: 12 });
}

/** The label of an axis, or the name alone where the label is longer than the axis. */
function fitting({ label, name }, length) {
  return 6.6 * label.length > length ? name : label;
}

function corners({ left, top, width, height }) {
  const [right, bottom] = [left + width, top + height];
  return [left, top, right, top, right, bottom, left, bottom];
}

/** What an axis of a variable needs. */
export function axisOf({ name, label, universe: [low, high] }) {
  return { low, high, name, label: label === name ? name : `${name}: ${label}` };
}
