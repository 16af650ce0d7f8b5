/* One point explained: memberships, the rules that fire, what comes out. */

import { html } from "./elements.js";
import { icon } from "./icons.js";
import { shown, tidy, typed } from "./numbers.js";
import { placeKey } from "./cells.js";
import { axesOf, outputsOf, piecesOf, signOf } from "./rulebase.js";

export const title = "Explain";
// Rules that fire less are counted but not listed.
const LEAST = 1e-6;

/** Keep `store.explanation` that of `store.point`; gives the functions that move the point. */
export function followPoint(app) {
  const { socket, store, say } = app;
  let asked = "";

  store.follow(["state", "point", "connected"], async ({ state, point, connected }) => {
    if (!point) asked = "";
    if (!point || !state?.rulebase || !connected) return;
    if (state.rulebase.inputs.some(({ name }) => !(name in point))) {
      // The point is one of another rule base.
      store.set({ point: null, explanation: null });
      return;
    }
    const inputs = complete(state.rulebase, point);
    const wanted = JSON.stringify([state.version, inputs]);
    if (wanted === asked) return;
    asked = wanted;
    try {
      const explanation = await socket.latest("explain", "explain", { inputs });
      if (explanation && store.now.point) store.set({ explanation: { ...explanation, inputs } });
    } catch (error) {
      store.set({ explanation: null });
      say(error.message, "error");
    }
  });

  /** Explain the point with these values of inputs; the others stay where they were. */
  function explain(values) {
    const { state, point } = store.now;
    const all = complete(state.rulebase, { ...point, ...values });
    for (const name of Object.keys(all)) all[name] = tidy(Number(all[name].toPrecision(6)));
    store.set({ point: all });
  }

  /** Move the point by so many fortieths of the first and the second axis. */
  function stepPoint(right, up) {
    const { state, point } = store.now;
    if (!state?.rulebase) return;
    const from = complete(state.rulebase, point ?? {});
    const moved = axesOf(state.rulebase, store.now.axes).map(({ name, universe: [low, high] }, k) => {
      const next = from[name] + ([right, up][k] * (high - low)) / 40;
      return [name, Math.max(low, Math.min(high, next))];
    });
    explain(Object.fromEntries(moved));
  }

  return { explain, stepPoint };
}

/** A value for each input: that of the point, or the middle of the universe. */
function complete(rulebase, point) {
  return Object.fromEntries(
    rulebase.inputs.map(({ name, universe: [low, high] }) => [
      name,
      Number.isFinite(point[name]) ? point[name] : (low + high) / 2,
    ]),
  );
}

export function mount(element, app) {
  const { store } = app;
  const fields = html("div", { class: "fields" });
  const body = html("div", { class: "body explanation" });
  const clear = html(
    "button",
    {
      type: "button",
      class: "quiet",
      title: "Explain no point",
      "aria-label": "Explain no point",
      onclick: () => store.set({ point: null, explanation: null }),
    },
    icon("remove"),
  );
  element.append(
    html("header", {}, html("h2", {}, title), fields, html("span", { class: "space" }), clear),
    body,
  );

  function showFields(inputs, point) {
    if (fields.dataset.names !== inputs.map(({ name }) => name).join()) {
      fields.dataset.names = inputs.map(({ name }) => name).join();
      fields.replaceChildren(...inputs.map((one) => field(one)));
    }
    inputs.forEach(({ name }, k) => {
      const box = fields.children[k].querySelector("input");
      if (document.activeElement !== box || box.dataset.moved) {
        box.value = point ? String(tidy(point[name] ?? NaN)).replace("NaN", "") : "";
      }
    });
  }

  function field({ name, label, universe: [low, high] }) {
    const box = html("input", {
      type: "text",
      inputmode: "decimal",
      size: 6,
      title: `${label || name}, from ${shown(low)} to ${shown(high)}`,
      onchange: () => {
        const value = typed(box.value);
        if (Number.isFinite(value)) app.explain({ [name]: value });
        else app.say(`${name}: type a number from ${shown(low)} to ${shown(high)}`, "error");
      },
      onkeydown: (event) => {
        const step = { ArrowUp: 1, ArrowDown: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        const from = store.now.point?.[name] ?? (low + high) / 2;
        box.dataset.moved = "yes";
        app.explain({ [name]: Math.max(low, Math.min(high, from + (step * (high - low)) / 40)) });
        delete box.dataset.moved;
      },
    });
    return html("label", {}, html("span", {}, name), box);
  }

  store.follow(["state", "point", "explanation"], ({ state, point, explanation }) => {
    const inputs = state?.rulebase?.inputs ?? [];
    showFields(inputs, point);
    const cleared = !point && document.activeElement === clear;
    clear.hidden = !point;
    if (cleared) fields.querySelector("input")?.focus();
    if (point && explanation) body.replaceChildren(...describe(state.rulebase, explanation, store));
    else body.replaceChildren(invitation(app));
  });
}

function invitation(app) {
  return html(
    "div",
    { class: "empty" },
    html("p", {}, "Click the surface or type a point: the rules that fire there are shown here and in the table."),
    html("button", { type: "button", onclick: () => app.stepPoint(0, 0) }, "Explain the middle"),
  );
}

function describe(rulebase, { memberships, rules, outputs, gains }, store) {
  const fired = rules.filter(({ strength }) => strength > LEAST);
  return [
    html(
      "dl",
      { class: "results" },
      Object.entries({ ...outputs, ...gains }).map(([name, value]) =>
        html(
          "div",
          { title: name },
          html("dt", {}, signOf(name)),
          html("dd", {}, Number.isFinite(value) ? shown(value, 5) : "no rule fires"),
        ),
      ),
    ),
    html(
      "div",
      { class: "memberships" },
      Object.entries(memberships).map(([name, grades]) =>
        html(
          "div",
          {},
          html("span", { class: "name" }, name),
          Object.entries(grades)
            .filter(([, grade]) => grade > LEAST)
            .map(([set, grade]) => html("span", { class: "grade" }, `${set} `, html("b", {}, shown(grade, 3)))),
        ),
      ),
    ),
    html(
      "table",
      { class: "fired" },
      html(
        "thead",
        {},
        html("tr", {}, ["rule", "then", "strength"].map((text) => html("th", { scope: "col" }, text))),
      ),
      html("tbody", {}, fired.map((rule) => row(rulebase, rule, store))),
    ),
    fired.length ? null : html("p", { class: "note" }, "No rule fires at this point."),
  ].filter(Boolean);
}

function row(rulebase, rule, store) {
  const { rules } = rulebase;
  const { place, index } = rule;
  const known = place && rules.form === "table"
    ? { [rules.columns]: rules.column_sets[place[1]], [rules.rows]: rules.row_sets[place[0]] }
    : rules.rules?.[index]?.if;
  // The answer may still be that for the rules before.
  const said = place ? rules.cells?.[place[0]]?.[place[1]] : rules.rules?.[index];
  const words = Object.entries(known ?? {}).map(([name, set]) => `${name} ${set}`).join(" · ");
  const bar = html("span", { class: "bar" });
  bar.style.setProperty("--share", `${100 * rule.strength}%`);
  return html(
    "tr",
    {},
    html(
      "td",
      {},
      html(
        "button",
        { type: "button", class: "link", title: "Select this rule", onclick: () => store.set({ cell: placeKey(place, index) }) },
        words || rule.text,
      ),
    ),
    html("td", {}, said ? wordsOf(said, rulebase) : ""),
    html("td", {}, html("span", { class: "strength" }, bar, shown(rule.strength, 3))),
  );
}

function wordsOf(rule, rulebase) {
  return piecesOf(rule, rulebase.rules.form, outputsOf(rulebase))
    .map(({ text }) => text)
    .join("");
}
