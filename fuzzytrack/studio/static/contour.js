/* The surface from above: colors, lines of equal value, the sets along the edges, visits. */

import { axisOf, drawAxes, drawColorBar } from "./axes.js";
import { color, token } from "./colors.js";
import { html } from "./elements.js";
import { shown, ticks } from "./numbers.js";
import { pictureMenu } from "./pictures.js";
import { signOf } from "./rulebase.js";
import { shapeOf } from "./shapes.js";
import { makeStage } from "./stage.js";
import { nameOf, paletteOf, rangeOf, spotOf } from "./surfacevalues.js";

export const title = "Contours";
// Pixels of the colored image between two points of the surface.
const FINE = 4;

export function mount(element, app) {
  const { store } = app;
  const canvas = html("canvas", {
    tabindex: 0,
    role: "application",
    "aria-roledescription": "contour map",
    "aria-describedby": "contour-keys",
  });
  const under = html("span", { class: "muted" });
  const note = html("p", { class: "note", hidden: true });
  const stage = makeStage(canvas, draw);

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      html("span", { class: "space" }),
      under,
      pictureMenu("the contours", () => `${store.now.state.name}-${store.now.shown}-contours`, stage.file),
    ),
    html("div", { class: "canvas" }, canvas, note),
    html(
      "p",
      { id: "contour-keys", class: "unseen" },
      "Arrow keys move the explained point, with Shift ten times as far.",
    ),
  );

  function draw(pen, width, height) {
    const { values } = store.now;
    if (values?.rows > 1) drawMap(pen, boxOf(width, height, values), store.now);
  }

  function at(event) {
    const { values } = store.now;
    if (!(values?.rows > 1)) return null;
    const box = boxOf(canvas.clientWidth, canvas.clientHeight, values);
    const shares = [
      (event.offsetX - box.left) / box.width,
      1 - (event.offsetY - box.top) / box.height,
    ];
    if (shares.some((share) => share < 0 || share > 1)) return null;
    return Object.fromEntries(
      values.axes.map(({ name, universe: [low, high] }, k) => [name, low + shares[k] * (high - low)]),
    );
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const point = at(event);
    if (point) app.explain(point);
  });
  canvas.addEventListener("pointermove", (event) => {
    const point = at(event);
    if (point && event.buttons === 1) app.explain(point);
    const spot = point && spotOf(store.now.values, point);
    under.textContent = spot
      ? [...Object.entries(point), [signOf(store.now.values.output), spot.height]]
          .map(([name, value]) => `${name} ${shown(value, 3)}`)
          .join("  ")
      : "";
  });
  canvas.addEventListener("pointerleave", () => (under.textContent = ""));
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[
      event.key
    ];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    app.stepPoint(...step.map((part) => part * (event.shiftKey ? 10 : 1)));
  });

  store.follow(["values"], ({ values }) => {
    note.hidden = !values || values.rows > 1;
    note.textContent = "With one input there is a curve, which is drawn as the surface.";
    canvas.setAttribute(
      "aria-label",
      values ? `Contours of ${values.output}` : "No contours: the rule base has complaints",
    );
  });
  store.follow(
    ["values", "point", "palette", "scheme", "visits", "shadeVisits", "view"],
    stage.redraw,
  );
}

function boxOf(width, height, { axes }) {
  // Beside the map are the names of the sets of the second input, and the color bar.
  const names = 12 + 6 * Math.max(...axes[1].sets.map(({ name }) => name.length));
  return { left: 58, top: 30, width: width - 124 - names, height: height - 76, names };
}

function drawMap(pen, box, { values, point, palette, visits, shadeVisits }) {
  const range = rangeOf(values);
  const scale = paletteOf(values, palette);
  const [x, y] = values.axes.map(axisOf);
  pen.image(colored(values, scale, range), box.left, box.top, box.width, box.height);
  // Where a difference is zero it is so over wide areas, whose edge would be noise.
  const levels = ticks(...range, 9).filter((level) => !values.against || level !== 0);
  const lines = levels.map((level) => contour(values, level, box));
  const paint = token(values.against ? "--contour-dark" : "--contour");
  for (const line of lines) pen.segments(line, paint, 1);
  if (shadeVisits && visits) drawVisits(pen, box, visits);
  label(pen, box, levels, lines);
  drawAxes(pen, box, x, y);
  drawSets(pen, box, values.axes);
  drawColorBar(
    pen,
    { left: box.left + box.width + box.names + 10, top: box.top + 6, height: Math.min(180, box.height - 12) },
    scale,
    range,
    nameOf(values),
  );
  const spot = point && spotOf(values, point);
  if (spot) drawCross(pen, box, spot.shares);
}

function drawCross(pen, box, [across, up]) {
  const [x, y] = [box.left + across * box.width, box.top + (1 - up) * box.height];
  pen.line([x, box.top, x, box.top + box.height], token("--pin"), 1, [3, 3]);
  pen.line([box.left, y, box.left + box.width, y], token("--pin"), 1, [3, 3]);
  pen.circle(x, y, 5, token("--pin"), token("--halo"), 2);
}

/** Values between the points are interpolated before they become colors. */
function colored({ columns, rows, heights }, palette, [low, high]) {
  const [width, height] = [(columns - 1) * FINE, (rows - 1) * FINE];
  const canvas = html("canvas", { width, height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  let at = 0;
  for (let top = 0; top < height; top += 1) {
    const up = (height - top - 0.5) / FINE;
    const j = Math.floor(up);
    for (let left = 0; left < width; left += 1, at += 4) {
      const across = (left + 0.5) / FINE;
      const i = Math.floor(across);
      const k = j * columns + i;
      const lower = heights[k] + (heights[k + 1] - heights[k]) * (across - i);
      const [a, b] = [heights[k + columns], heights[k + columns + 1]];
      const upper = a + (b - a) * (across - i);
      const value = lower + (upper - lower) * (up - j);
      if (Number.isNaN(value)) continue;
      const paint = color(palette, (value - low) / (high - low));
      image.data[at] = paint[0];
      image.data[at + 1] = paint[1];
      image.data[at + 2] = paint[2];
      image.data[at + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Segments of the line of one level: each cell is cut where its edges pass the level. */
function contour({ columns, rows, heights }, level, { left, top, width, height }) {
  const found = [];
  const [stepX, stepY] = [width / (columns - 1), height / (rows - 1)];
  for (let j = 0; j < rows - 1; j += 1) {
    for (let i = 0; i < columns - 1; i += 1) {
      const k = j * columns + i;
      const corner = [heights[k], heights[k + 1], heights[k + columns + 1], heights[k + columns]];
      const cuts = [];
      for (let edge = 0; edge < 4; edge += 1) {
        const [from, to] = [corner[edge], corner[(edge + 1) % 4]];
        if (from < level === to < level || Number.isNaN(from + to)) continue;
        const share = (level - from) / (to - from);
        const x = [share, 1, 1 - share, 0][edge];
        const y = [0, share, 1, 1 - share][edge];
        cuts.push(left + (i + x) * stepX, top + height - (j + y) * stepY);
      }
      // At a saddle there are four cuts, two lines.
      if (cuts.length >= 4) found.push(...cuts);
    }
  }
  return found;
}

/** One number for each level, where there is most room. */
function label(pen, box, levels, lines) {
  const taken = [];
  lines.forEach((line, k) => {
    let best = null;
    for (let at = 0; at < line.length; at += 8) {
      const [x, y] = [line[at], line[at + 1]];
      const edge = Math.min(
        x - box.left - 16, box.left + box.width - 16 - x, y - box.top - 8, box.top + box.height - 8 - y,
      );
      const room = Math.min(edge, ...taken.map((other) => Math.hypot(x - other.x, y - other.y)));
      if (room > (best?.room ?? 4)) best = { x, y, room };
    }
    if (!best || best.room < 6) return;
    taken.push(best);
    pen.text(best.x, best.y, shown(levels[k]), { fill: "#fff", align: "middle", size: 10, halo: "#0009" });
  });
}

/** Names of the sets along the upper and right edge, at their peaks. */
function drawSets(pen, box, axes) {
  const fill = token("--muted");
  axes.forEach(({ sets, universe: [low, high] }, axis) => {
    const reach = axis === 0 ? box.width : box.height;
    let last = -Infinity;
    for (const one of sets) {
      const [, b, c] = shapeOf(one).quad(one.parameters);
      const middle = (Math.max(low, Math.min(b, high)) + Math.min(high, Math.max(c, low))) / 2;
      const place = ((middle - low) / (high - low)) * reach;
      const needed = axis === 0 ? 5 + 6 * one.name.length : 11;
      if (place - last < needed) continue;
      last = place;
      if (axis === 0) {
        pen.text(box.left + place, box.top - 9, one.name, { fill, align: "middle", size: 10 });
      } else pen.text(box.left + box.width + 5, box.top + box.height - place, one.name, { fill, size: 10 });
    }
  });
}

/** A dot in each cell that was visited; its area grows with the logarithm of the visits. */
function drawVisits(pen, box, { counts }) {
  const most = Math.log1p(Math.max(1, ...counts.flat()));
  const largest = Math.min(box.width, box.height) / counts.length / 1.6;
  counts.forEach((row, j) =>
    row.forEach((count, i) => {
      if (!count) return;
      const x = box.left + ((i + 0.5) / row.length) * box.width;
      const y = box.top + (1 - (j + 0.5) / counts.length) * box.height;
      pen.circle(x, y, largest * Math.sqrt(Math.log1p(count) / most), "#fffc", "#0008", 0.5);
    }),
  );
}
