/* A picture of the experiment: its heading, controls, and the menu that saves it. */

import { token } from "./colors.js";
import { html, svg } from "./elements.js";
import { COLORS, lineStyle } from "./lines.js";
import { pictureMenu, svgFile } from "./pictures.js";

const ROW = 18;

/**
 * The picture: `name` is that of its file, `part` a chart or a map with {element, picture}, `lines()`
 * gives what its lines are, [[name, index], ...], and `controls` are shown beside the heading.
 */
export function figure({ store }, heading, name, part, lines, controls = [], of = scenarioOf) {
  const file = () => withKey(svgFile(part.picture, token("--panel")), lines());
  const fileName = () => `${of(store.now) ?? "studio"}-${name}`;
  return html(
    "figure",
    { class: "picture" },
    html(
      "figcaption",
      {},
      html("h3", {}, heading),
      controls,
      pictureMenu(heading.toLowerCase(), fileName, file),
    ),
    part.element,
  );
}

function scenarioOf({ results }) {
  return results?.scenario;
}

/** The file with the names of the lines below the picture, which stand beside it on the page. */
function withKey(file, lines) {
  if (!lines.length) return file;
  const root = new DOMParser().parseFromString(file, "image/svg+xml").documentElement;
  const [, , width, height] = root.getAttribute("viewBox").split(" ").map(Number);
  const whole = height + lines.length * ROW + 6;
  root.setAttribute("viewBox", `0 0 ${width} ${whole}`);
  root.setAttribute("height", whole);
  lines.forEach(([text, index], k) => {
    const y = height + ROW * (k + 0.5);
    const { "stroke-dasharray": dashes } = lineStyle(index);
    root.append(
      svg("line", {
        x1: 16,
        x2: 44,
        y1: y,
        y2: y,
        stroke: token(`--c${index % COLORS}`),
        "stroke-width": 2.5,
        "stroke-dasharray": dashes,
      }),
      svg(
        "text",
        { x: 52, y: y + 4, fill: token("--ink"), "font-size": 12, "font-family": "sans-serif" },
        text,
      ),
    );
  });
  return new XMLSerializer().serializeToString(root);
}
