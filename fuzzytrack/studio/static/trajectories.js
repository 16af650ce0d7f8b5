/* Tracks on a map: truth, plots, estimates of trackers, and the scans without a plot. */

import { svg } from "./elements.js";
import { colorClass, lineStyle, pathOf } from "./lines.js";

const MOST_PLOTS = 3000;

/**
 * A layer of a map. `read()` gives {truth, plots, lines: [{index, points, coasted}], upto}: points
 * are [x, y] a scan, null where there is none, `coasted` scans are drawn as squares, and of all
 * only the first `upto` scans are shown.
 */
export function trajectoryLayer(read) {
  const element = svg("g", {});

  function draw(place) {
    const { truth = [], plots = [], lines = [], upto = Infinity } = read();
    const put = ([x, y = 0]) => (known(x) && known(y) ? [place.x(x), place.y(y)] : [NaN, NaN]);
    const until = (list) => list.slice(0, upto);
    const dots = until(plots)
      .map(put)
      .filter(([x]) => known(x))
      .slice(-MOST_PLOTS);
    element.replaceChildren(
      svg("path", { class: "truth", d: pathOf(truth.map(put)) }),
      svg("path", { class: "plots", d: dots.map(([x, y]) => cross(x, y)).join("") }),
      ...lines.flatMap(({ index, points, coasted = [] }) => {
        const at = until(points).map(put);
        const squares = at.filter((point, k) => coasted[k] && known(point[0])).map(([x, y]) => square(x, y));
        return [
          svg("path", { ...lineStyle(index), d: pathOf(at) }),
          svg("path", { class: `coasted ${colorClass(index)}`, d: squares.join("") }),
        ];
      }),
    );
  }

  return { element, draw };
}

function known(value) {
  return typeof value === "number" && Number.isFinite(value);
}

function cross(x, y) {
  return `M${x - 2.5} ${y - 2.5}l5 5m0-5l-5 5`;
}

function square(x, y) {
  return `M${x - 3} ${y - 3}h6v6h-6z`;
}
