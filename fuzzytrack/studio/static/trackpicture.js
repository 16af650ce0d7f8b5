/* Tracks of one run: on a map, or over time if they have one axis only. */

import { makeChart } from "./chart.js";
import { html } from "./elements.js";
import { boundsOf, makeMap } from "./map.js";
import { trajectoryLayer } from "./trajectories.js";

/**
 * The picture. `read()` gives what `trajectoryLayer` draws, with `time` and the `name` of each line;
 * `layers` lie above it on the map, `cursor()` is a time to be marked.
 */
export function makeTrackPicture(name, read, layers = [], cursor = () => null) {
  const chart = makeChart();
  const map = makeMap({ name: `${name}: arrow keys move the map, + and − zoom, 0 shows all`, bounds });
  map.add(trajectoryLayer(read));
  for (const layer of layers) map.add(layer);
  const element = html("div", { class: "track-picture" }, map.element, chart.element);

  function bounds() {
    const { truth = [], plots = [] } = read();
    return boundsOf([...truth, ...plots].map(([x, y = 0]) => [x, y]));
  }

  function isFlat() {
    const { plots = [] } = read();
    return plots[0]?.length === 1;
  }

  function redraw() {
    const flat = isFlat();
    map.element.hidden = flat;
    chart.element.hidden = !flat;
    if (flat) chart.show(overTime(name, read(), cursor()));
    else map.redraw();
  }

  return {
    element,
    redraw,
    fit: map.fit,
    get picture() {
      return isFlat() ? chart.picture : map.picture;
    },
  };
}

function overTime(name, { time, truth, plots, lines, upto = Infinity }, cursor) {
  const of = (points) => points.map((point, k) => (k < upto ? point[0] : null));
  return {
    name,
    x: { label: "time (s)" },
    y: { label: "position (m)" },
    cursor,
    series: [
      ...(truth?.length ? [{ name: "truth", index: -1, x: time, y: truth.map(([x]) => x) }] : []),
      { name: "plots", index: -1, kind: "dots", x: time, y: of(plots) },
      ...lines.map(({ index, name: line, points }) => ({ name: line, index, x: time, y: of(points) })),
    ],
  };
}
