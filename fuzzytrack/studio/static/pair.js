/* Two designs side by side: their curves, the paired difference, and both tracks of the first run. */

import { makeChart } from "./chart.js";
import { errorsOf, finite, namesOf, trajectoriesOf } from "./curves.js";
import { html, select } from "./elements.js";
import { figure } from "./figure.js";
import { isBusy } from "./jobbar.js";
import { keyOf } from "./lines.js";
import { shown } from "./numbers.js";
import { makeTrackPicture } from "./trackpicture.js";

export function mount(element, app) {
  const { store, socket } = app;
  const first = select("First design", [], "", (name) => choose(0, name));
  const second = select("Second design", [], "", (name) => choose(1, name));
  const swap = html(
    "button",
    { type: "button", onclick: () => store.set({ pair: [...store.now.pair].reverse() }) },
    "Swap",
  );
  const verdict = html("p", { class: "difference", "aria-live": "polite" });
  const note = html("p", { class: "note" }, "Run at least two trackers to compare them.");
  const lines = () => store.now.pair.map((name) => [name, namesOf(store.now.results).indexOf(name)]);
  const errors = makeChart();
  const difference = makeChart();
  const maps = [0, 1].map((which) => {
    const name = `Trajectory of the ${["first", "second"][which]} design`;
    return makeTrackPicture(name, () => lineOf(store.now, store.now.pair[which]));
  });
  const headings = [html("span", {}), html("span", {})];
  const body = html(
    "div",
    { class: "pictures" },
    figure(app, "Error over time", "pair-errors", errors, lines),
    figure(app, "Paired difference over time", "pair-difference", difference, () => []),
    ...maps.map((map, k) =>
      figure(app, `Trajectory, ${["first", "second"][k]}`, `pair-track-${k + 1}`, map, () => [lines()[k]], [
        headings[k],
      ]),
    ),
  );
  let answered = null;

  element.append(
    html(
      "div",
      { class: "actions" },
      html("label", { class: "inline" }, "First", first),
      html("label", { class: "inline" }, "Second", second),
      swap,
    ),
    verdict,
    note,
    body,
  );

  function choose(which, name) {
    const pair = [...store.now.pair];
    pair[which] = name;
    store.set({ pair });
  }

  async function ask(now) {
    const { results, pair, jobs, resultsTab } = now;
    const names = results ? namesOf(results) : [];
    const possible = names.length > 1;
    note.hidden = possible || !results;
    body.hidden = verdict.hidden = !possible;
    if (!possible) return;
    if (pair.some((name) => !names.includes(name)) || pair[0] === pair[1]) {
      const other = names.find((name) => name !== pair[0]);
      store.set({ pair: names.includes(pair[0]) ? [pair[0], other] : names.slice(0, 2) });
      return;
    }
    [first, second].forEach((each, k) => {
      each.replaceChildren(...names.map((name) => html("option", { value: name }, name)));
      each.value = pair[k];
      headings[k].replaceChildren(keyOf([[pair[k], names.indexOf(pair[k])]]));
    });
    draw(now);
    // The difference is known when all runs are done.
    if (resultsTab !== "pair" || isBusy(jobs.run)) return;
    const wanted = JSON.stringify([pair, results.seed, results.runs, results.scenario, jobs.run?.id]);
    if (wanted === answered) return;
    answered = wanted;
    try {
      const found = await socket.send("paired", { first: pair[0], second: pair[1] });
      verdict.replaceChildren(...sentence(found, pair));
      difference.show(differenceOf(results, pair, found.over_time));
    } catch (error) {
      verdict.textContent = error.message;
    }
  }

  function draw({ results, pair, quantity, hidden }) {
    const both = namesOf(results).filter((name) => !pair.includes(name));
    errors.show(errorsOf({ results, hidden: both, quantity, band: "se" }));
    for (const map of maps) map.redraw();
  }

  store.follow(["results", "pair", "resultsTab", "jobs", "scheme", "view"], ask);
  let scenario = null;
  store.follow(["results"], ({ results }) => {
    if (results && scenario !== results.scenario) for (const map of maps) map.fit();
    scenario = results?.scenario;
  });
}

function lineOf({ results }, name) {
  if (!results) return {};
  return trajectoriesOf({ results, hidden: namesOf(results).filter((each) => each !== name) });
}

/** Second minus first, scan by scan, with a band of two standard errors. */
function differenceOf(results, [one, other], { difference: y, se }) {
  const around = (times) =>
    y.map((value, k) => (finite(value) && finite(se[k]) ? value + times * se[k] : null));
  return {
    name: `Difference of the distance of prediction, ${other} minus ${one}`,
    x: { label: "time (s)" },
    y: { label: "second − first, mean (m)" },
    limits: [{ y: 0, label: "" }],
    series: [
      {
        name: "difference",
        index: namesOf(results).indexOf(other),
        x: results.time,
        y,
        low: around(-2),
        high: around(2),
      },
    ],
  };
}

function sentence({ difference, se, low, high, level, runs }, [one, other]) {
  if (!Number.isFinite(difference)) return ["No run has both trackers with a score."];
  const sure = low > 0 || high < 0;
  const word = difference < 0 ? "better" : "worse";
  return [
    html("b", {}, `${shown(difference, 4)} m`),
    ` ± ${shown(se, 2)} m: RMSE of prediction, ${other} minus ${one}, paired over ${runs} runs; `,
    `${Math.round(100 * level)} % interval ${shown(low, 4)} to ${shown(high, 4)} m. `,
    sure ? `The second is ${word}.` : "The interval has 0 in it: no difference is shown.",
  ];
}
