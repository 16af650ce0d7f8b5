/* The table of the sets of a variable: names, shapes and numbers that are typed. */

import { chosenSet, currentVariable, stepOf } from "./chosenset.js";
import { lineColor, shareOf } from "./colors.js";
import { ask } from "./dialogs.js";
import { html, select } from "./elements.js";
import { keepFocus } from "./focus.js";
import { icon } from "./icons.js";
import { tidy, typed } from "./numbers.js";
import { SHAPES, isDrawn, reshaped, shapeOf } from "./shapes.js";
import { textLink } from "./textlink.js";

const SHAPES_OF_TEXT =
  "Type the numbers of shapes that are links; to change the shape, follow the link. A linear set has " +
  "no curve: it is the sum of the inputs times its numbers, and of the constant.";

/** Make the table; `show()` fills it with the sets as `drag` has them. */
export function makeSetTable(app, drag) {
  const { store, say } = app;
  const table = html("table", { class: "numbers-table" });
  const note = html("p", { class: "hint" });

  function show() {
    const sets = drag.sets();
    const structure = JSON.stringify([
      currentVariable(store.now).name, store.now.palette, store.now.scheme, sets.map(({ name, shape, line }) => [name, shape, line]),
    ]);
    if (table.dataset.structure !== structure) {
      table.dataset.structure = structure;
      keepFocus(table, () => fillTable(sets));
    }
    showHeads(sets);
    note.textContent = sets.every(isDrawn) ? "" : SHAPES_OF_TEXT;
    sets.forEach((one, k) => {
      const row = table.tBodies[0].rows[k];
      row.classList.toggle("chosen", one.name === chosenSet(store.now));
      row.querySelectorAll("input.number").forEach((box, i) => {
        if (document.activeElement !== box || drag.held()) box.value = rounded(one.parameters[i]);
      });
    });
  }

  /** The parameters of the chosen set stand over the columns. */
  function showHeads(sets) {
    const own = shapeOf(sets.find(({ name }) => name === chosenSet(store.now))).parameters;
    longest(sets).forEach((name, k) => {
      table.tHead.rows[0].cells[2 + k].textContent = own[k] ?? name;
    });
  }

  function fillTable(sets) {
    const most = longest(sets).length;
    const heads = ["set", "shape", ...longest(sets)].map((text) => html("th", { scope: "col" }, text));
    const last = html("th", { scope: "col" }, html("span", { class: "unseen" }, "remove"));
    table.replaceChildren(
      html("thead", {}, html("tr", {}, heads, last)),
      html("tbody", {}, sets.map((one) => numberRow(one, most))),
    );
  }

  function numberRow(one, most) {
    const { palette } = store.now;
    const swatch = html("button", {
      type: "button",
      class: "swatch",
      title: `Choose ${one.name}`,
      "aria-label": `Choose ${one.name}`,
      onclick: () => store.set({ set: one.name }),
    });
    swatch.style.setProperty("--paint", lineColor(palette, shareOf(currentVariable(store.now), one.name)));
    const fields = shapeOf(one).parameters.map((name, k) => html("td", {}, numberBox(one, name, k)));
    const rest = Array.from({ length: most - fields.length }, () => html("td"));
    return html(
      "tr",
      { onfocusin: () => store.set({ set: one.name }) },
      html("th", { scope: "row" }, swatch, nameBox(one)),
      html("td", {}, shapeBox(one)),
      ...fields,
      ...rest,
      html(
        "td",
        {},
        html(
          "button",
          {
            type: "button",
            class: "quiet",
            title: `Remove ${one.name}`,
            "aria-label": `Remove ${one.name}`,
            onclick: () => remove(one.name),
          },
          icon("remove"),
        ),
      ),
    );
  }

  function numberBox(one, name, k) {
    const box = html("input", {
      type: "text",
      inputmode: "decimal",
      class: "number",
      title: name,
      "aria-label": `${one.name}, ${name}`,
      onchange: () => change(typed(box.value)),
      onkeydown: (event) => {
        const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
        if (!direction) return;
        event.preventDefault();
        const value = tidy(typed(box.value) + direction * (event.shiftKey ? 10 : 1) * stepOf(store.now));
        box.value = String(value);
        change(value);
      },
    });

    function change(value) {
      const now = currentVariable(store.now).sets.find((set) => set.name === one.name);
      if (!Number.isFinite(value)) {
        say(`${one.name}, ${name}: type a number.`, "error");
        box.value = rounded(now.parameters[k]);
        return;
      }
      drag.send(drag.followed(now, now.parameters.with(k, value)), false).then((done) => {
        if (!done) box.value = rounded(now.parameters[k]);
      });
    }

    return box;
  }

  function nameBox(one) {
    const box = html("input", {
      type: "text",
      class: "set-name",
      spellcheck: "false",
      size: Math.max(3, one.name.length),
      "aria-label": `Name of the set ${one.name}`,
      onchange: async () => {
        const name = box.value.trim();
        const done = await app.edit("rename_set", { variable: currentVariable(store.now).name, set: one.name, name });
        if (done) store.set({ set: name });
        else box.value = one.name;
      },
    });
    box.value = one.name;
    return box;
  }

  function shapeBox(one) {
    // A shape that the page does not draw stays what it is; its numbers may be typed.
    if (!isDrawn(one)) return textLink(app, one.shape, one.line, true);
    const shapes = Object.entries(SHAPES).map(([key, { title: text }]) => [key, text]);
    return select(`Shape of ${one.name}`, shapes, one.shape, (shape) => {
      const now = currentVariable(store.now).sets.find(({ name }) => name === one.name);
      const parameters = reshaped(now, shape, stepOf(store.now) / 10).map(tidy);
      drag.send([{ set: one.name, shape, parameters }], false);
    });
  }

  function remove(set) {
    const args = { variable: currentVariable(store.now).name, set, shared: store.now.shared };
    app.edit("remove_set", args, ({ message }) =>
      ask(`Remove ${set} from ${args.variable}?`, [html("p", {}, message)], [
        ["Remove it with its rules", () => app.edit("remove_set", { ...args, with_rules: true })],
      ]),
    );
  }

  return { element: table, note, show };
}

/** Add a set in the middle of the variable. */
export function addSet(app) {
  const { store } = app;
  const { name, sets, universe } = currentVariable(store.now);
  const [low, high] = universe;
  let k = sets.length + 1;
  while (sets.some((one) => one.name === `set${k}`)) k += 1;
  const [middle, reach] = [(low + high) / 2, (high - low) / 8];
  const parameters = [middle - reach, middle, middle + reach].map(tidy);
  app
    .edit("add_set", { variable: name, set: `set${k}`, shape: "trimf", parameters })
    .then((done) => done && store.set({ set: `set${k}` }));
}

/** Names of the parameters of a set that has most of them. */
function longest(sets) {
  const all = sets.map((one) => shapeOf(one).parameters);
  return all.reduce((best, one) => (one.length > best.length ? one : best));
}

/** A parameter as it fits its field; what is not typed anew keeps all its digits. */
function rounded(parameter) {
  return String(Number(parameter.toPrecision(4)));
}
