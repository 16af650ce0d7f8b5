/* The plane of α and β: the stability triangle, gains that can be reached, gains of the last run. */

import { choice, html, svg } from "./elements.js";
import { enable, isEnabled } from "./focus.js";
import { shown, span, ticks } from "./numbers.js";
import { pictureMenu, svgFile } from "./pictures.js";
import { token } from "./colors.js";

export const title = "Gain plane";
const WHOLE = [[0, 2], [0, 4]];
const MARGIN = { left: 58, right: 16, top: 12, bottom: 40 };

export function mount(element, app) {
  const { socket, store, say } = app;
  const picture = svg("svg", { class: "plane", role: "img", "aria-label": "nothing yet" });
  const range = choice("Range of the axes", (planeRange) => store.set({ planeRange }));
  const verdict = html("p", { class: "verdict", "aria-live": "polite" });
  const certify = html("button", { type: "button", onclick: prove }, "Certify");
  const note = html("p", { class: "note", hidden: true });
  let asked = null;

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      range.element,
      html("span", { class: "space" }),
      certify,
      pictureMenu("the gain plane", () => `${store.now.state.name}-gains`, () =>
        svgFile(picture, token("--panel")),
      ),
    ),
    html("div", { class: "canvas" }, picture, note),
    verdict,
  );

  /** Gains are asked for only where they are looked at. */
  async function ask() {
    const { state, view, connected } = store.now;
    if (!state?.rulebase || !connected || !app.isShown("gains", view)) return;
    const { gains } = state.rulebase;
    note.hidden = Boolean(gains);
    picture.classList.toggle("gone", !gains);
    enable(certify, gains);
    if (!gains) {
      note.textContent =
        "The outputs of this rule base are no gains. Outputs stiffness and damping, stiffness " +
        "alone, or alpha and beta can be shown here.";
      return;
    }
    const wanted = `${state.version} ${store.now.runs}`;
    if (wanted === asked) return;
    asked = wanted;
    verdict.replaceChildren();
    try {
      const answer = await socket.latest("gains", "gains", {});
      if (answer) store.set({ gains: answer });
    } catch (error) {
      note.hidden = false;
      note.textContent = error.message;
    }
  }

  async function prove() {
    if (!isEnabled(certify)) return;
    enable(certify, false);
    verdict.textContent = "Certifying…";
    try {
      const { verdict: word, sentence, counter_example: example } = await socket.send("certify");
      const worst = example ? html("span", { class: "mono" }, ` Counter-example: ${spelled(example)}`) : null;
      verdict.replaceChildren(...[html("b", { class: word }, word), ` ${sentence}`, worst].filter(Boolean));
    } catch (error) {
      verdict.textContent = "";
      say(error.message, "error");
    }
    enable(certify, Boolean(store.now.state?.rulebase?.gains));
  }

  function draw() {
    const { gains, planeRange, explanation } = store.now;
    const { clientWidth: width, clientHeight: height } = picture;
    if (!width || !height || !gains) return;
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    picture.setAttribute("aria-label", described(gains));
    const [x, y] = planeRange === "near" ? nearby(gains) : WHOLE;
    const place = {
      x: (value) => MARGIN.left + ((value - x[0]) / (x[1] - x[0])) * (width - MARGIN.left - MARGIN.right),
      y: (value) =>
        height - MARGIN.bottom - ((value - y[0]) / (y[1] - y[0])) * (height - MARGIN.top - MARGIN.bottom),
    };
    picture.replaceChildren(
      ...background(place, gains, width, height),
      ...visited(place, gains.visited),
      ...current(place, explanation?.gains),
      ...axes(place, x, y, width, height),
      ...legend(gains, explanation?.gains, width),
    );
  }

  store.follow(["planeRange"], ({ planeRange }) =>
    range.show([["whole", "triangle", "The whole triangle of stability"], ["near", "reachable", "The gains that the rules reach"]], planeRange),
  );
  store.follow(["state", "view", "runs", "connected"], ask);
  store.follow(["gains", "planeRange", "explanation", "scheme", "view"], draw);
  new ResizeObserver(draw).observe(picture);
}

function spelled(example) {
  return typeof example === "string" ? example : JSON.stringify(example);
}

function described({ reachable, visited }) {
  const [alphas, betas] = [0, 1].map((k) => span(reachable.map((pair) => pair[k])).map((v) => shown(v, 3)));
  const seen = visited?.length ? `; ${visited.length} pairs visited by the last run` : "";
  return `Reachable: alpha from ${alphas.join(" to ")}, beta from ${betas.join(" to ")}${seen}`;
}

function nearby({ reachable, visited }) {
  const points = [...reachable, ...(visited ?? [])];
  return [0, 1].map((k) => {
    const [low, high] = span(points.map((pair) => pair[k]));
    const margin = 0.15 * (high - low);
    // Above there is room for what the marks mean.
    return [Math.max(0, low - margin), high + (k ? 3 : 1) * margin];
  });
}

function polygon(place, points, attributes) {
  const pairs = points.map(([a, b]) => `${place.x(a)},${place.y(b)}`).join(" ");
  return svg("polygon", { points: pairs, ...attributes });
}

function background(place, { triangle, reachable, hull }, width, height) {
  const box = { x: MARGIN.left, y: MARGIN.top };
  const size = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
  const clip = svg("clipPath", { id: "plane-clip" }, svg("rect", { ...box, ...size }));
  const inside = svg("g", { "clip-path": "url(#plane-clip)" });
  inside.append(polygon(place, triangle, { class: "triangle" }));
  if (hull.length) inside.append(polygon(place, hull, { class: "reachable" }));
  const dots = reachable.map(([a, b]) => `M${place.x(a).toFixed(1)} ${place.y(b).toFixed(1)}h0`);
  inside.append(svg("path", { class: "cloud", d: dots.join("") }));
  return [clip, svg("rect", { class: "ground", ...box, ...size }), inside];
}

function visited(place, points = []) {
  const most = Math.log1p(Math.max(1, ...points.map(([, , count]) => count)));
  return points.map(([a, b, count]) => {
    const share = Math.log1p(count) / most;
    const [cx, cy] = [place.x(a), place.y(b)];
    return svg("circle", { class: "visit", cx, cy, r: 1 + 2.5 * share, "fill-opacity": 0.15 + 0.6 * share });
  });
}

function current(place, gains) {
  if (!Number.isFinite(gains?.alpha) || !Number.isFinite(gains?.beta)) return [];
  return [svg("circle", { class: "pin", cx: place.x(gains.alpha), cy: place.y(gains.beta), r: 5 })];
}

/** What the marks mean, in the upper right corner, where no stable gains are. */
function legend({ visited: seen }, gains, width) {
  const entries = [["reachable", "reachable"]];
  if (seen?.length) entries.push(["visit", "last run"]);
  if (gains) entries.push(["pin", "explained point"]);
  return entries.flatMap(([kind, text], k) => {
    const y = MARGIN.top + 16 + 18 * k;
    const x = width - MARGIN.right - 16;
    return [
      svg("circle", { class: kind, cx: x, cy: y - 4, r: 4.5 }),
      svg("text", { x: x - 12, y, "text-anchor": "end" }, text),
    ];
  });
}

function axes(place, x, y, width, height) {
  const parts = [];
  const bottom = height - MARGIN.bottom;
  for (const value of ticks(...x, (width - 60) / 70)) {
    const at = place.x(value);
    parts.push(svg("line", { class: "tick", x1: at, x2: at, y1: bottom, y2: bottom + 4 }));
    parts.push(svg("text", { class: "number", x: at, y: bottom + 16, "text-anchor": "middle" }, shown(value)));
  }
  for (const value of ticks(...y, (height - 40) / 40)) {
    const at = place.y(value);
    parts.push(svg("line", { class: "tick", x1: MARGIN.left - 4, x2: MARGIN.left, y1: at, y2: at }));
    parts.push(svg("text", { class: "number", x: MARGIN.left - 7, y: at + 4, "text-anchor": "end" }, shown(value)));
  }
  const middle = (MARGIN.left + width - MARGIN.right) / 2;
  parts.push(svg("text", { class: "axis", x: middle, y: height - 6, "text-anchor": "middle" }, "position gain α"));
  const up = (MARGIN.top + bottom) / 2;
  parts.push(
    svg(
      "text",
      { class: "axis", "text-anchor": "middle", transform: `translate(12 ${up}) rotate(-90)` },
      "velocity gain β",
    ),
  );
  return parts;
}
