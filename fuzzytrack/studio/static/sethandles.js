/* The handles by which a set is moved: its corners, and itself as a whole. */

import { svg } from "./elements.js";
import { shown, tidy } from "./numbers.js";
import { clamp } from "./setcurves.js";
import { shapeOf } from "./shapes.js";

// Moves a set as a whole, as dragging its curve does.
export const WHOLE = { name: "whole set", grade: 0.5 };

/** What a set is moved by: its corners, and itself as a whole. */
export function handlesOf(one) {
  const { corners } = shapeOf(one);
  return corners.length > 1 ? [...corners, WHOLE] : corners;
}

export function placeOf(one, corner) {
  if (corner !== WHOLE) return corner.place(one.parameters);
  const [, b, c] = shapeOf(one).quad(one.parameters);
  return (b + c) / 2;
}

/** A handle; `heard` are what it does on keys and when it is left. */
export function makeHandle(set, corner, heard) {
  return svg(
    "g",
    { class: "handle", role: "slider", tabindex: 0, "aria-label": `${set}, ${corner.name}`, ...heard },
    svg("circle", { class: "reach", r: 13 }),
    corner === WHOLE
      ? svg("rect", { class: "knob", x: -4.5, y: -4.5, width: 9, height: 9 })
      : svg("circle", { class: "knob", r: 5.5 }),
  );
}

/** Put a handle where it is on the picture, and tell screen readers of its value. */
export function putHandle(handle, at, one, corner) {
  const value = placeOf(one, corner);
  handle.setAttribute("transform", `translate(${at.x(clamp(value, at))} ${at.y(corner.grade)})`);
  handle.classList.toggle("outside", value < at.low || value > at.high);
  for (const [name, number] of [["now", value], ["min", at.low], ["max", at.high]]) {
    handle.setAttribute(`aria-value${name}`, tidy(number));
  }
  handle.setAttribute("aria-valuetext", shown(value));
}
