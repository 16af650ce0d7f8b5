/* One run, scan by scan: a time slider, the track so far, innovations, gains, and the rules that fire. */

import { makeChart } from "./chart.js";
import { first } from "./curves.js";
import { html, select, svg } from "./elements.js";
import { numberField } from "./fields.js";
import { figure } from "./figure.js";
import { keyOf } from "./lines.js";
import { shown } from "./numbers.js";
import { chosenTrackers } from "./pick.js";
import { makeTrackPicture } from "./trackpicture.js";

const AXES = ["x", "y", "z"];
const PLAY_MS = 180;

export function mount(element, app) {
  const { store, socket, say } = app;
  const tracker = select("Tracker", [], "", (value) =>
    store.set({ walked: { ...store.now.walked, tracker: value } }),
  );
  const run = numberField("Run", "", (value) => store.set({ walked: { ...store.now.walked, run: value } }), {
    least: 0,
    whole: true,
  });
  const slider = html("input", {
    type: "range",
    min: 0,
    value: 0,
    step: 1,
    "aria-label": "Scan",
    oninput: () => go(Number(slider.value)),
  });
  const play = html("button", { type: "button", onclick: toggle }, "Play");
  const when = html("output", { class: "mono" });
  const plot = html("dl", { class: "plot-facts" });
  const rules = html("div", {
    class: "scroll",
    tabindex: 0,
    role: "region",
    "aria-label": "Rules that fire",
  });
  const innovations = makeChart((value) => goTo(value));
  const gains = makeChart((value) => goTo(value));
  const marks = markLayer(
    () => walk,
    () => at,
  );
  const track = makeTrackPicture("The track up to the scan of the slider", soFar, [marks], () => walk.t[at]);
  const innovationKey = html("span", {});
  const gainKey = html("span", {});
  const instead = html("p", { class: "note", role: "status" });
  const notes = html("ul", { class: "notes", tabindex: 0, "aria-label": "Notes", hidden: true });
  const body = html(
    "div",
    { class: "pictures" },
    figure(app, "Track", "walk-track", track, () => []),
    html("div", { class: "picture" }, html("h3", {}, "At this scan"), plot, rules),
    figure(app, "Innovation", "walk-innovation", innovations, () => linesIn(innovationsOf(walk, null)), [
      innovationKey,
    ]),
    figure(app, "Gains", "walk-gains", gains, () => linesIn(gainsOf(walk, null)), [gainKey]),
  );
  let walk = null;
  let at = 0;
  let asked = null;
  let timer = null;

  element.append(
    html(
      "div",
      { class: "actions slider-row" },
      html("label", { class: "inline" }, "Tracker", tracker),
      run.element,
      play,
      slider,
      when,
    ),
    instead,
    notes,
    body,
  );

  async function ask(now) {
    const { walked, seed, asked: last, resultsTab, connected, scenario, state, view } = now;
    const texts = last?.trackers ?? chosenTrackers(now.trackers);
    tracker.replaceChildren(...texts.map((text) => html("option", { value: text }, text)));
    if (texts.length && !texts.includes(walked.tracker)) {
      store.set({ walked: { ...walked, tracker: texts[0] } });
      return;
    }
    tracker.value = walked.tracker;
    run.show(walked.run);
    if (resultsTab !== "walk" || view !== "run" || !connected || !texts.length) return;
    const args = { tracker: walked.tracker, run: walked.run, seed: last?.seed ?? seed };
    const wanted = JSON.stringify([args, scenario?.text, state?.text]);
    if (wanted === asked) return;
    asked = wanted;
    tell(`Run ${args.run} of ${args.tracker} is computed…`);
    try {
      const found = await socket.latest("walk", "walk", args);
      if (!found) return;
      walk = found;
      tell(null);
      notes.hidden = !walk.notes.length;
      notes.replaceChildren(...walk.notes.map((text) => html("li", {}, text)));
      slider.max = String(walk.t.length - 1);
      at = Math.min(at, walk.t.length - 1);
      track.fit();
      go(at);
    } catch (error) {
      tell(error.message);
    }
  }

  /** Say what is there instead of a run; null shows the run. */
  function tell(text) {
    instead.textContent = text ?? "";
    instead.hidden = text === null;
    body.hidden = text !== null;
    notes.hidden = true;
  }

  function go(scan) {
    at = scan;
    slider.value = String(scan);
    if (!walk) return;
    const time = walk.t[scan];
    when.value = `scan ${scan} of ${walk.t.length - 1}, ${shown(time, 6)} s`;
    slider.setAttribute("aria-valuetext", when.value);
    for (const [chart, key, picture] of [
      [innovations, innovationKey, innovationsOf(walk, time)],
      [gains, gainKey, gainsOf(walk, time)],
    ]) {
      chart.show(picture);
      key.replaceChildren(keyOf(linesIn(picture)));
    }
    plot.replaceChildren(...factsOf(walk, scan));
    rules.replaceChildren(...rulesOf(walk.inputs[scan], tracker.value === "editor" ? explain : null));
    track.redraw();
  }

  /** Show the inputs of a scan in the rule table and on the surface. */
  function explain(point) {
    app.show({ point });
  }

  function goTo(time) {
    if (!walk) return;
    const distances = walk.t.map((each) => Math.abs(each - time));
    go(distances.indexOf(Math.min(...distances)));
  }

  function soFar() {
    if (!walk) return {};
    const coasted = walk.seen.map((seen) => !seen);
    const line = {
      name: tracker.value,
      index: Math.max(0, tracker.selectedIndex),
      points: walk.estimates,
      coasted,
    };
    return { time: walk.t, truth: walk.truth ?? [], plots: walk.plots, upto: at + 1, lines: [line] };
  }

  function toggle() {
    if (timer !== null) return stop();
    if (!walk) return say("There is no run to play yet.");
    if (at >= walk.t.length - 1) go(0);
    play.textContent = "Pause";
    timer = setInterval(() => (at >= walk.t.length - 1 ? stop() : go(at + 1)), PLAY_MS);
  }

  function stop() {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
  }

  store.follow(
    ["walked", "seed", "asked", "trackers", "resultsTab", "connected", "scenario", "state", "view"],
    ask,
  );
  store.follow(["scheme", "resultsTab", "view"], () => go(at));
}

/** The plot, the prediction and the line between them, which is the innovation. */
function markLayer(read, at) {
  const group = svg("g", {});

  function draw(place) {
    group.replaceChildren();
    const walk = read();
    if (!walk) return;
    const [plot, predicted] = [walk.plots, walk.predicted].map((list) => list[at()]);
    const put = ([x, y = 0]) => [place.x(x), place.y(y)];
    const has = (point) => point?.every((value) => Number.isFinite(value));
    if (has(plot) && has(predicted)) {
      const [[x1, y1], [x2, y2]] = [put(predicted), put(plot)];
      group.append(svg("line", { class: "innovation", x1, y1, x2, y2 }));
    }
    if (has(predicted)) {
      const [x, y] = put(predicted);
      group.append(svg("path", { class: "predicted", d: `M${x} ${y - 6}l6 6-6 6-6-6z` }));
    }
    if (has(plot)) {
      const [cx, cy] = put(plot);
      group.append(svg("circle", { class: "plot", cx, cy, r: 5 }));
    }
  }

  return { element: group, draw };
}

function linesIn({ series }) {
  return series.map(({ name, index }) => [name, index]);
}

function innovationsOf(walk, cursor) {
  const axes = walk.plots[0].length;
  return {
    name: "Innovation of each plot, plot minus prediction",
    x: { label: "time (s)" },
    y: { label: "innovation (m)" },
    limits: [{ y: 0, label: "" }],
    cursor,
    series: AXES.slice(0, axes).map((axis, k) => ({
      name: axis,
      index: k,
      x: walk.t,
      y: walk.innovations.map((row) => row[k]),
    })),
  };
}

function gainsOf({ t, gains }, cursor) {
  const signs = { alpha: "α", beta: "β", gamma: "γ" };
  const series = Object.entries(signs).flatMap(([key, sign], index) => {
    const y = gains[key]?.map(first) ?? [];
    return y.some((value) => Number.isFinite(value) && (key !== "gamma" || value !== 0))
      ? [{ name: sign, index, x: t, y }]
      : [];
  });
  return { name: "Gains of the first axis", x: { label: "time (s)" }, y: { label: "gain" }, cursor, series };
}

function factsOf({ seen, plots, predicted, innovations, gains }, scan) {
  const numbers = (list, unit) =>
    list?.[scan]?.every?.((value) => Number.isFinite(value))
      ? `${list[scan].map((value) => shown(value, 5)).join(", ")} ${unit}`
      : "–";
  const gain = (list) => {
    const values = [list?.[scan]]
      .flat()
      .filter((value) => Number.isFinite(value))
      .map((value) => shown(value, 4));
    return [...new Set(values)].join(", ") || "–";
  };
  const facts = [
    ["Plot", seen[scan] ? numbers(plots, "m") : "none: the track is coasted"],
    ["Predicted", numbers(predicted, "m")],
    ["Innovation", numbers(innovations, "m")],
    ["α", gain(gains.alpha)],
    ["β", gain(gains.beta)],
  ];
  if ([gains.gamma?.[scan]].flat().some((value) => Number.isFinite(value) && value !== 0))
    facts.push(["γ", gain(gains.gamma)]);
  return facts.flatMap(([name, value]) => [html("dt", {}, name), html("dd", {}, value)]);
}

/** Tables of the rules that fire, one for each axis, or one if the axes share their gains; `explain` shows a point. */
function rulesOf(lanes, explain) {
  const known = lanes.filter(Boolean);
  if (!known.length)
    return [
      html(
        "p",
        { class: "note" },
        "No rule fires here: the track is not started, or its gains come from no rule base.",
      ),
    ];
  return known.map(({ values, rules }, k) =>
    html(
      "table",
      { class: "fired-rules" },
      html(
        "caption",
        {},
        known.length > 1 ? `${AXES[k]}: ` : "",
        Object.entries(values)
          .map(([name, value]) => `${name} = ${shown(value, 4)}`)
          .join(", "),
        explain
          ? html("button", { type: "button", class: "link", onclick: () => explain(values) }, "in the rules")
          : null,
      ),
      html(
        "tbody",
        {},
        rules.map(({ text, strength }) =>
          html("tr", {}, html("td", {}, bar(strength)), html("td", {}, text)),
        ),
      ),
    ),
  );
}

function bar(strength) {
  const element = html("span", { class: "bar" });
  element.style.setProperty("--share", `${100 * strength}%`);
  return html("span", { class: "firing" }, element, html("b", {}, strength.toFixed(2)));
}
