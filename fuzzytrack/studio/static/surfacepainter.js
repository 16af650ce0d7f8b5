/* A surface in three dimensions: faces from the farthest to the nearest, axes, and the explained point. */

import { axisOf, drawColorBar } from "./axes.js";
import { color, css, mix, token } from "./colors.js";
import { shown, ticks } from "./numbers.js";
import { nameOf, paletteOf, rangeOf, spotOf } from "./surfacevalues.js";

const HEIGHT = 0.85;
// How far a face reaches below the next one, which hides it; else the ground would shine through.
const OVERLAP = 0.4;
const GRAY = [150, 150, 150];
// From the viewer's upper left, in (right, up, toward the viewer).
const LIGHT = [-0.42, 0.55, 0.72];

/** Draws a surface in three dimensions of a size, and finds what is under a place of it. */
export class SurfacePainter {
  constructor({ values, camera, point, palette, visits, shadeVisits }, width, height) {
    Object.assign(this, { values, width, height, point });
    this.palette = paletteOf(values, palette);
    this.range = rangeOf(values);
    this.share = shadeVisits && visits ? visitShares(visits) : null;
    this.paints = new Map();
    this.#look(camera);
  }

  #look({ azimuth, elevation, zoom }) {
    const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
    this.toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
    this.right = [-Math.sin(a), Math.cos(a), 0];
    this.up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    const tall = Math.SQRT2 * Math.sin(e) + HEIGHT * Math.cos(e);
    const [wide, high] = [this.width - 150, this.height - 76];
    this.scale = zoom * Math.max(8, Math.min(wide / 2 / Math.SQRT2, high / 2 / tall));
    this.center = [(this.width - 46) / 2, this.height / 2 - 8];
    this.near = this.toward.map((part) => (part >= 0 ? 1 : -1));
    this.light = [0, 1, 2].map(
      (k) => LIGHT[0] * this.right[k] + LIGHT[1] * this.up[k] + LIGHT[2] * this.toward[k],
    );
  }

  /** Place on the screen of a point of the box [-1, 1] × [-1, 1] × [-HEIGHT, HEIGHT]. */
  at(x, y, z) {
    const { right, up, scale, center } = this;
    return [
      center[0] + scale * (right[0] * x + right[1] * y),
      center[1] - scale * (up[0] * x + up[1] * y + up[2] * z),
    ];
  }

  /** Height in the box of a value. */
  level(value) {
    const [low, high] = this.range;
    return HEIGHT * ((2 * (value - low)) / (high - low) - 1);
  }

  draw(pen) {
    this.#walls(pen);
    this.#faces(pen);
    this.#pin(pen);
    this.#labels(pen);
    const high = Math.min(180, this.height - 90);
    const box = { left: this.width - 54, top: 32, height: high };
    drawColorBar(pen, box, this.palette, this.range, nameOf(this.values));
  }

  #walls(pen) {
    const [fill, line] = [token("--wall"), token("--wall-line")];
    const [bx, by] = [-this.near[0], -this.near[1]];
    const face = (...corners) => corners.flatMap((corner) => this.at(...corner));
    const h = HEIGHT;
    pen.polygon(face([-1, -1, -h], [1, -1, -h], [1, 1, -h], [-1, 1, -h]), fill, line, 1);
    pen.polygon(face([bx, -1, -h], [bx, 1, -h], [bx, 1, h], [bx, -1, h]), fill, line, 1);
    pen.polygon(face([-1, by, -h], [1, by, -h], [1, by, h], [-1, by, h]), fill, line, 1);
    for (const x of this.#ticks(0)) pen.line(face([x, by, h], [x, by, -h], [x, -by, -h]), line);
    for (const y of this.#ticks(1)) pen.line(face([bx, y, h], [bx, y, -h], [-bx, y, -h]), line);
    for (const value of ticks(...this.range, 4)) {
      const z = this.level(value);
      pen.line(face([-bx, by, z], [bx, by, z], [bx, -by, z]), line);
    }
  }

  /** Places in the box of the ticks of an input. */
  #ticks(axis) {
    const { low, high } = axisOf(this.values.axes[axis]);
    return ticks(low, high, 5).map((value) => (2 * (value - low)) / (high - low) - 1);
  }

  /** Faces from the farthest to the nearest, which hides what lies behind without sorting. */
  #faces(pen) {
    const { columns, rows, heights } = this.values;
    const [low, high] = this.range;
    const { places, levels } = this.#project();
    const line = token("--mesh");
    const step = Math.max(1, Math.round((columns - 1) / 20));
    const [face, edge] = [new Float64Array(8), new Float64Array(4)];
    const [nearX, nearY] = this.near;
    /** A corner, moved toward the next faces to be drawn if it is on their side. */
    const put = (at, i, j, right, up) => {
      const k = j * columns + i;
      const [x, y] = [i + nearX, j + nearY];
      const besides = right && x >= 0 && x < columns ? k + nearX : k;
      const behind = up && y >= 0 && y < rows ? k + nearY * columns : k;
      for (let part = 0; part < 2; part += 1) {
        const own = places[2 * k + part];
        const far = places[2 * besides + part] + places[2 * behind + part] - 2 * own;
        face[2 * at + part] = Number.isNaN(far) ? own : own + OVERLAP * far;
      }
    };
    const draw = (a, k) => {
      edge.set([places[2 * a], places[2 * a + 1], places[2 * k], places[2 * k + 1]]);
      pen.line(edge, line, 0.6);
    };
    this.#eachFace((i, j) => {
      const a = j * columns + i;
      const [b, c, d] = [a + 1, a + columns + 1, a + columns];
      const mean = (heights[a] + heights[b] + heights[c] + heights[d]) / 4;
      if (Number.isNaN(mean)) return;
      put(0, i, j, nearX < 0, nearY < 0);
      put(1, i + 1, j, nearX > 0, nearY < 0);
      put(2, i + 1, j + 1, nearX > 0, nearY > 0);
      put(3, i, j + 1, nearX < 0, nearY > 0);
      const light = this.#brightness(levels, a, b, c, d);
      const seen = this.share?.((i + 0.5) / (columns - 1), (j + 0.5) / (rows - 1)) ?? 1;
      pen.polygon(face, this.#paint((mean - low) / (high - low), light, seen));
      if (j % step === 0) draw(a, b);
      if (i % step === 0) draw(a, d);
    });
  }

  /** Color of a face; the same few hundred come again and again. */
  #paint(share, light, seen) {
    const steps = [255 * share, 40 * light, 15 * seen].map(Math.round);
    const key = (steps[0] * 64 + steps[1]) * 16 + steps[2];
    let found = this.paints.get(key);
    if (!found) {
      const plain = color(this.palette, share);
      // Without a visit it is gray; the more visits, the more color.
      const paint = seen === 1 ? plain : mix(GRAY, plain, seen ? 0.3 + 0.7 * seen : 0);
      found = css(paint, steps[1] / 40);
      this.paints.set(key, found);
    }
    return found;
  }

  #eachFace(visit) {
    const { columns, rows } = this.values;
    const order = (count, near) =>
      Array.from({ length: count - 1 }, (_, k) => (near > 0 ? k : count - 2 - k));
    const across = order(columns, this.near[0]);
    for (const j of order(rows, this.near[1])) for (const i of across) visit(i, j);
  }

  #project() {
    const { columns, rows, heights } = this.values;
    const places = new Float32Array(2 * heights.length);
    const levels = new Float32Array(heights.length);
    for (let k = 0; k < heights.length; k += 1) {
      levels[k] = this.level(heights[k]);
      const [x, y] = [k % columns, Math.floor(k / columns)];
      places.set(this.at((2 * x) / (columns - 1) - 1, (2 * y) / (rows - 1) - 1, levels[k]), 2 * k);
    }
    return { places, levels };
  }

  /** How bright a face is: its normal against the light. */
  #brightness(levels, a, b, c, d) {
    const { columns, rows } = this.values;
    const slopeX = ((levels[b] + levels[c] - levels[a] - levels[d]) * (columns - 1)) / 4;
    const slopeY = ((levels[c] + levels[d] - levels[a] - levels[b]) * (rows - 1)) / 4;
    const length = Math.sqrt(1 + slopeX * slopeX + slopeY * slopeY);
    const cosine = (this.light[2] - this.light[0] * slopeX - this.light[1] * slopeY) / length;
    return 0.66 + 0.4 * Math.max(0, cosine);
  }

  /** The explained point: a pin from the floor to the surface. */
  #pin(pen) {
    const spot = this.point && spotOf(this.values, this.point);
    if (!spot) return;
    const [x, y] = spot.shares.map((part) => 2 * part - 1);
    const [foot, head] = [this.at(x, y, -HEIGHT), this.at(x, y, this.level(spot.height))];
    pen.line([...foot, ...head], token("--halo"), 3.5);
    pen.line([...foot, ...head], token("--pin"), 1.5);
    pen.circle(...head, 5, token("--pin"), token("--halo"), 2);
  }

  #labels(pen) {
    const [muted, ink] = [token("--muted"), token("--ink")];
    this.values.axes.forEach((one, axis) => {
      const { low, high, name } = axisOf(one);
      const edge = (share, out) => {
        const along = 2 * share - 1;
        const beside = this.near[1 - axis] * out;
        return axis === 0 ? this.at(along, beside, -HEIGHT) : this.at(beside, along, -HEIGHT);
      };
      const align = edge(0.5, 1)[0] < this.center[0] ? "end" : "start";
      for (const value of ticks(low, high, 5)) {
        const share = (value - low) / (high - low);
        pen.line([...edge(share, 1), ...edge(share, 1.04)], muted);
        const [x, y] = edge(share, 1.08);
        pen.text(x, y + 5, shown(value), { fill: muted, align });
      }
      const [x, y] = edge(0.5, 1.08);
      const aside = align === "end" ? -24 : 24;
      pen.text(x + aside, y + 20, name, { fill: ink, align, size: 13, weight: 600 });
    });
    this.#heights(pen, muted);
  }

  /** Numbers of the vertical axis, at the edge of the box that is farthest left. */
  #heights(pen, muted) {
    const [nx, ny] = this.near;
    const edges = [[nx, -ny], [-nx, ny]];
    const [x, y] = edges.sort((one, two) => this.at(...one, 0)[0] - this.at(...two, 0)[0])[0];
    for (const value of ticks(...this.range, 4)) {
      const [left, top] = this.at(x, y, this.level(value));
      pen.line([left - 4, top, left, top], muted);
      pen.text(left - 8, top - 3, shown(value), { fill: muted, align: "end" });
    }
  }

  /** Values of the inputs under a place of the screen, on the nearest face there; or null. */
  pick(left, top) {
    const { columns, rows, axes, heights } = this.values;
    const { places } = this.#project();
    let found = null;
    this.#eachFace((i, j) => {
      const a = j * columns + i;
      const face = [a, a + 1, a + columns + 1, a + columns];
      if (face.some((k) => Number.isNaN(heights[k]))) return;
      // The last face that covers the place is the nearest.
      if (covers(face.map((k) => [places[2 * k], places[2 * k + 1]]), left, top)) found = [i, j];
    });
    if (!found) return null;
    const shares = [(found[0] + 0.5) / (columns - 1), (found[1] + 0.5) / (rows - 1)];
    return shares.map((share, k) => {
      const [low, high] = axes[k].universe;
      return low + share * (high - low);
    });
  }
}

/** Share of the visits near a place, from 0 to 1, on a logarithmic scale. */
function visitShares({ counts }) {
  // The mean with the neighbors: a single run leaves more specks than areas.
  const even = counts.map((row, j) => row.map((_, i) => meanAround(counts, i, j)));
  const most = Math.log1p(Math.max(1, ...even.flat()));
  return (x, y) => {
    const row = even[Math.min(even.length - 1, Math.floor(y * even.length))];
    return Math.log1p(row[Math.min(row.length - 1, Math.floor(x * row.length))]) / most;
  };
}

function meanAround(counts, i, j) {
  let sum = 0;
  for (const row of counts.slice(Math.max(0, j - 1), j + 2)) {
    for (const count of row.slice(Math.max(0, i - 1), i + 2)) sum += count;
  }
  return sum / 9;
}

function covers(corners, x, y) {
  let inside = false;
  corners.forEach(([x1, y1], k) => {
    const [x2, y2] = corners[(k + 1) % corners.length];
    if (y1 > y !== y2 > y && x < ((x2 - x1) * (y - y1)) / (y2 - y1) + x1) inside = !inside;
  });
  return inside;
}
