/* The values of a surface: the range and the name of its heights, and where a point is on it. */

import { span } from "./numbers.js";
import { signOf } from "./rulebase.js";

/** The range of the colors; differences have 0 in the middle. */
export function rangeOf(values) {
  const [low, high] = span(values.heights);
  if (!values.against) return [low, high];
  const most = Math.max(Math.abs(low), Math.abs(high));
  return [-most, most];
}

export function paletteOf(values, palette) {
  return values.against ? "difference" : palette;
}

/** What the heights are. */
export function nameOf({ output, against }) {
  return against ? `Δ ${signOf(output)}` : signOf(output);
}

/** Where a point lies on the drawn surface: shares of the axes, and the height there. */
export function spotOf({ axes, columns, rows, heights }, point) {
  const shares = axes.map(({ name, universe: [low, high] }) =>
    Math.max(0, Math.min(1, (point[name] - low) / (high - low))),
  );
  if (shares.some(Number.isNaN)) return null;
  const [x, y] = [shares[0] * (columns - 1), (shares[1] ?? 0) * (rows - 1)];
  const [i, j] = [Math.min(columns - 2, Math.floor(x)), Math.max(0, Math.min(rows - 2, Math.floor(y)))];
  const row = (k) => {
    const start = Math.min(rows - 1, k) * columns + i;
    return heights[start] + (heights[start + 1] - heights[start]) * (x - i);
  };
  const height = row(j) + (row(j + 1) - row(j)) * (y - j);
  return Number.isNaN(height) ? null : { shares, height };
}
