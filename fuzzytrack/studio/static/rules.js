/* The rules: a table of words colored by consequent, or a list; edited cell by cell. */

import { color, css, ink, mix, shareOf, token } from "./colors.js";
import { check, html, select } from "./elements.js";
import { SvgPen } from "./pens.js";
import { pictureMenu } from "./pictures.js";
import {
  consequents, outputsOf, piecesOf, variable, withConfidence, withShare, withWord,
} from "./rulebase.js";
import { complaintRow } from "./text.js";
import { typed } from "./numbers.js";

export const title = "Rules";

export function mount(element, app) {
  const { store } = app;
  const grid = html("table", { class: "rules", role: "grid", "aria-label": "Rules" });
  const words = html("div", { class: "words" });
  const operators = html("div", { class: "operators" });
  const about = html("p", { class: "about" });
  const complaints = html("div", { class: "complaints", "aria-live": "polite" });
  const coloring = html("span");
  let slots = [];
  let shape = "";
  let painted = "";
  let editor = null;

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      app.tabs(),
      html("span", { class: "space" }),
      coloring,
      pictureMenu("the rules", () => `${store.now.state.name}-rules`, () => tableFile(grid)),
    ),
    html("div", { class: "scroll" }, grid),
    words,
    operators,
    complaints,
    about,
  );

  // ------------------------------------------------------------------ the grid

  function build(rulebase) {
    const { rules } = rulebase;
    slots = rules.form === "table" ? tableSlots(rules) : listSlots(rules);
    for (const slot of slots) {
      slot.box = html("span", { class: "words" });
      slot.td = html("td", { role: "gridcell", tabindex: -1, class: "cell" }, slot.box);
      slot.td.addEventListener("focus", () => choose(slot));
      slot.td.addEventListener("dblclick", () => open(slot));
      slot.td.addEventListener("keydown", (event) => key(event, slot));
      slot.td.addEventListener("copy", (event) => copy(event, slot));
      slot.td.addEventListener("paste", (event) => paste(event, slot));
    }
    grid.classList.toggle("list", rules.form === "list");
    grid.replaceChildren(...(rules.form === "table" ? tableRows(rulebase, slots) : listRows(rulebase, slots)));
  }

  function paint() {
    const { state, colorBy: output, palette, explanation, cell } = store.now;
    const { rulebase } = state;
    const target = variable(rulebase, output);
    const fired = strengths(explanation);
    const wrong = complaintsByKey(state.complaints);
    for (const slot of slots) {
      const rule = slot.rule(rulebase.rules);
      const said = target ? consequents(rule, output) : [];
      tint(slot, target, said, palette);
      write(slot.box, piecesOf(rule, rulebase.rules.form, outputsOf(rulebase)), output);
      const strength = fired?.get(slot.key);
      slot.td.classList.toggle("fired", Boolean(strength));
      slot.td.classList.toggle("idle", Boolean(fired) && !strength);
      slot.td.style.setProperty("--strength", `${Math.round(100 * (strength ?? 0))}%`);
      const complaint = wrong.get(slot.key);
      slot.td.toggleAttribute("aria-invalid", Boolean(complaint));
      slot.td.title = complaint ?? "";
      slot.td.setAttribute("aria-label", spoken(slot, rule, strength, complaint));
      const chosen = slot.key === cell;
      slot.td.tabIndex = chosen ? 0 : -1;
      slot.td.setAttribute("aria-selected", String(chosen));
    }
    if (!slots.some(({ td }) => td.tabIndex === 0) && slots.length) slots[0].td.tabIndex = 0;
  }

  function choose(slot) {
    store.set({ cell: slot.key });
  }

  function key(event, slot) {
    if (editor || event.altKey) return;
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    const near = step && slots.find((one) => one.y === slot.y + step[0] && one.x === slot.x + step[1]);
    if (event.ctrlKey || event.metaKey) return;
    if (step) near?.td.focus();
    else if (event.key === "Home") slots.find(({ y }) => y === slot.y).td.focus();
    else if (event.key === "End") slots.findLast(({ y }) => y === slot.y).td.focus();
    else if (event.key === "Enter" || event.key === "F2") open(slot);
    else if (event.key === "+" || event.key === "=") next(slot, 1);
    else if (event.key === "-") next(slot, -1);
    else if (event.key.length === 1 && event.key !== " ") open(slot, event.key);
    else return;
    event.preventDefault();
  }

  /** The next set of the output by which cells are colored. */
  function next(slot, step) {
    const { state, colorBy: output } = store.now;
    const sets = variable(state.rulebase, output).sets.map(({ name }) => name);
    const [said] = consequents(slot.rule(state.rulebase.rules), output);
    const set = sets[sets.indexOf(said?.set) + step];
    if (set) say(slot, output, set);
  }

  function say(slot, output, set) {
    const { rulebase } = store.now.state;
    change(slot, withWord(slot.rule(rulebase.rules), outputsOf(rulebase), output, set));
  }

  function share(slot, output, set) {
    const { rulebase } = store.now.state;
    change(slot, withShare(slot.rule(rulebase.rules), outputsOf(rulebase), output, set));
  }

  function change(slot, text, refused) {
    const symmetric = store.now.symmetric && slot.place.row !== undefined;
    return slot.place.rule === undefined
      ? app.edit("set_cell", { ...slot.place, text, symmetric }, refused)
      : app.edit("set_rule", { index: slot.place.rule, text }, refused);
  }

  // ------------------------------------------------------------------ typing

  function open(slot, start) {
    if (editor) return;
    const before = slot.rule(store.now.state.rulebase.rules).text;
    const box = html("input", {
      type: "text",
      class: "mono",
      spellcheck: "false",
      "aria-label": `${slot.name}: text of the rule`,
    });
    const refusal = html("div", { class: "refusal", role: "alert", hidden: true });
    box.value = start ?? before;
    editor = slot;
    slot.td.classList.add("editing");
    slot.td.append(box, refusal);
    box.focus();
    if (start === undefined) box.select();

    function close() {
      if (editor !== slot) return;
      editor = null;
      slot.td.classList.remove("editing");
      box.remove();
      refusal.remove();
    }

    /** Keep the text and go so many cells to the right. */
    async function commit(right) {
      if (box.value.trim() !== before) {
        const done = await change(slot, box.value.trim(), ({ message }) => {
          refusal.textContent = `${sentence(message)} Esc leaves the cell as it was.`;
          refusal.hidden = false;
          box.setAttribute("aria-invalid", "true");
        });
        if (!done) return;
      }
      close();
      (slots.find((one) => one.y === slot.y && one.x === slot.x + right) ?? slot).td.focus();
    }

    box.addEventListener("keydown", (event) => {
      event.stopPropagation();
      if (event.key === "Enter") commit(0);
      else if (event.key === "Tab") commit(event.shiftKey ? -1 : 1);
      else if (event.key === "Escape") {
        close();
        slot.td.focus();
      } else return;
      event.preventDefault();
    });
    box.addEventListener("blur", () => {
      // What was refused is dropped when the cell is left; the refusal was shown.
      if (editor !== slot) return;
      const text = box.value.trim();
      close();
      if (refusal.hidden && text !== before) change(slot, text);
    });
  }

  function copy(event, slot) {
    if (editor) return;
    event.clipboardData.setData("text/plain", slot.rule(store.now.state.rulebase.rules).text);
    event.preventDefault();
  }

  function paste(event, slot) {
    if (editor) return;
    change(slot, event.clipboardData.getData("text/plain").trim());
    event.preventDefault();
  }

  // ------------------------------------------------------------------ below the grid

  function showWords() {
    const { state, cell, colorBy: output, palette, symmetric } = store.now;
    const { rulebase } = state;
    const slot = slots.find(({ key: one }) => one === cell);
    if (!slot) {
      words.replaceChildren(html("p", { class: "hint" }, "Choose a cell, then its words here; or type in the cell."));
      return;
    }
    const rule = slot.rule(rulebase.rules);
    words.replaceChildren(
      html("div", { class: "where" }, html("b", {}, slot.name), html("span", { class: "mono" }, rule.text)),
      ...outputsOf(rulebase).map((name) => wordRow(slot, rule, variable(rulebase, name), palette, output)),
      html(
        "div",
        { class: "word-row" },
        html("span", { class: "name" }, "confidence"),
        sureBox(slot, rule),
        html("span", { class: "space" }),
        rulebase.rules.form === "table"
          ? check("symmetric", symmetric, (on) => store.set({ symmetric: on }),
              "Give the cell mirrored through the middle of the table the same words")
          : null,
      ),
    );
  }

  function wordRow(slot, rule, target, palette) {
    const said = consequents(rule, target.name).map(({ set }) => set);
    return html(
      "div",
      { class: "word-row", role: "group", "aria-label": target.name },
      html("span", { class: "name", title: target.label }, target.name),
      html(
        "div",
        { class: "chips" },
        target.sets.map(({ name }) => {
          const paint = color(palette, shareOf(target, name));
          const chip = html(
            "button",
            {
              type: "button",
              class: "chip",
              "aria-pressed": String(said.includes(name)),
              title: "With Shift besides the other sets",
              onclick: (event) => (event.shiftKey ? share : say)(slot, target.name, name),
            },
            name,
          );
          chip.style.setProperty("--paint", css(paint));
          chip.style.setProperty("--on-paint", ink(paint));
          return chip;
        }),
      ),
    );
  }

  function sureBox(slot, rule) {
    const sure = rule.weight;
    const box = html("input", {
      type: "text",
      inputmode: "decimal",
      size: 5,
      "aria-label": "Confidence of the rule, from 0 to 1",
      onchange: () => {
        const value = typed(box.value);
        const outputs = outputsOf(store.now.state.rulebase);
        if (value >= 0 && value <= 1) change(slot, withConfidence(rule, outputs, value));
        else app.say("Confidence: type a number from 0 to 1.", "error");
      },
    });
    box.value = sure === null ? "several" : String(sure);
    return box;
  }

  function showOperators({ operators: all }) {
    operators.dataset.known = JSON.stringify(all);
    operators.replaceChildren(
      ...Object.entries(all).map(([name, { value, choices }]) =>
        html(
          "label",
          {},
          html("span", {}, name),
          select(
            `Operator ${name}`,
            choices.map((one) => [one, one]),
            value,
            (wanted) => app.edit("set_operator", { operator: name, value: wanted }),
          ),
        ),
      ),
    );
  }

  function goTo({ where, line }) {
    const slot = slots.find((one) => one.key === keyOfComplaint(where));
    if (slot) slot.td.focus();
    else if (where?.set) store.set({ variable: where.variable, set: where.set });
    else app.show({ tab: "text", line });
  }

  store.follow(["state"], ({ state }) => {
    if (!state?.rulebase) return;
    const { rulebase } = state;
    const wanted = layoutOf(rulebase);
    if (wanted !== shape) {
      shape = wanted;
      editor = null;
      painted = "";
      build(rulebase);
    }
    if (JSON.stringify(rulebase.operators) !== operators.dataset.known) showOperators(rulebase);
    about.textContent = rulebase.description;
    complaints.replaceChildren(...state.complaints.map((one) => complaintRow(one, () => goTo(one))));
    const outputs = outputsOf(rulebase);
    if (!outputs.includes(store.now.colorBy)) store.set({ colorBy: outputs[0] });
  });
  store.follow(["shown"], ({ state, shown }) => {
    if (state?.rulebase && outputsOf(state.rulebase).includes(shown)) store.set({ colorBy: shown });
  });
  store.follow(["state", "colorBy"], ({ state, colorBy: output }) => {
    const outputs = state?.rulebase ? outputsOf(state.rulebase) : [];
    coloring.hidden = outputs.length < 2;
    coloring.replaceChildren(
      select(
        "Color cells by",
        outputs.map((name) => [name, `color ${name}`]),
        output,
        (name) => store.set({ colorBy: name }),
      ),
    );
  });
  store.follow(
    ["state", "colorBy", "palette", "explanation", "cell", "scheme", "symmetric"],
    ({ state, colorBy: output, palette, explanation, cell, scheme, symmetric }) => {
      if (!state?.rulebase) return;
      // While a set is dragged the state changes many times a second, and no rule does.
      const { rules, outputs } = state.rulebase;
      const sets = outputs.map((one) => one.sets.map(({ name }) => name));
      const looks = [output, palette, cell, scheme, symmetric];
      const now = JSON.stringify([rules, sets, state.complaints, explanation, looks]);
      if (now === painted) return;
      painted = now;
      paint();
      keepFocus(words, showWords);
    },
  );
}

// ---------------------------------------------------------------------- places of rules

function tableSlots({ rows, columns, row_sets: down, column_sets: across }) {
  return down.flatMap((row, y) =>
    across.map((column, x) => ({
      x,
      y,
      key: `${y},${x}`,
      place: { row, column },
      name: `${columns} ${column}, ${rows} ${row}`,
      rule: (rules) => rules.cells[y][x],
    })),
  );
}

function listSlots({ rules: all }) {
  return all.map((rule, y) => ({
    x: 0,
    y,
    key: String(y),
    place: { rule: y },
    name: `Rule ${y + 1}`,
    rule: (rules) => rules.rules[y],
  }));
}

function keyOfComplaint(where) {
  return where?.cell ? where.cell.join() : String(where?.rule ?? "");
}

function complaintsByKey(complaints) {
  return new Map(complaints.map(({ where, message }) => [keyOfComplaint(where), message]));
}

/** The key of a rule, as `store.cell` has it: "row,column" of a table, or the index in a list. */
export function placeKey(place, index) {
  return place ? place.join() : String(index);
}

function strengths(explanation) {
  if (!explanation) return null;
  return new Map(
    explanation.rules.map(({ place, index, strength }) => [placeKey(place, index), strength]),
  );
}

/** What the grid is built for; cells alone are changed in place, so the focus stays. */
function layoutOf({ rules, inputs }) {
  if (rules.form === "table") {
    return JSON.stringify([rules.rows, rules.columns, rules.row_sets, rules.column_sets]);
  }
  return JSON.stringify([inputs.map(({ name }) => name), rules.rules.map((one) => one.if)]);
}

// ---------------------------------------------------------------------- rows

function tableRows({ rules }, slots) {
  const { rows, columns, row_sets: down, column_sets: across } = rules;
  const head = html(
    "tr",
    { role: "row" },
    html("th", { class: "corner", scope: "col" }, html("span", {}, rows, " ╲ ", columns)),
    across.map((name) => html("th", { scope: "col", role: "columnheader" }, name)),
  );
  const lines = down.map((name, y) =>
    html(
      "tr",
      { role: "row" },
      html("th", { scope: "row", role: "rowheader" }, name),
      slots.filter((slot) => slot.y === y).map(({ td }) => td),
    ),
  );
  return [html("thead", { role: "rowgroup" }, head), html("tbody", { role: "rowgroup" }, lines)];
}

function listRows({ inputs, rules }, slots) {
  const head = html(
    "tr",
    { role: "row" },
    ["", ...inputs.map(({ name }) => `if ${name}`), "then"].map((text) =>
      html("th", { scope: "col", role: "columnheader" }, text),
    ),
  );
  const lines = rules.rules.map(({ if: conditions }, y) =>
    html(
      "tr",
      { role: "row" },
      html("th", { scope: "row", role: "rowheader" }, String(y + 1)),
      inputs.map(({ name }) =>
        html(
          "td",
          { role: "gridcell", class: name in conditions ? "if" : "if none" },
          conditions[name] ?? "any",
        ),
      ),
      slots[y].td,
    ),
  );
  return [html("thead", { role: "rowgroup" }, head), html("tbody", { role: "rowgroup" }, lines)];
}

// ---------------------------------------------------------------------- one cell

/** Color a cell by its sets of one output; several share it by their confidences. */
function tint({ td }, target, said, palette) {
  const ground = token("--panel").match(/\w\w/g).map((part) => parseInt(part, 16));
  const paints = said.map(({ set, confidence: sure }) =>
    mix(ground, color(palette, shareOf(target, set)), 0.25 + 0.75 * sure),
  );
  const total = said.reduce((sum, one) => sum + one.confidence, 0) || 1;
  let from = 0;
  const stops = paints.map((paint, k) => {
    const to = from + (100 * said[k].confidence) / total;
    const stop = `${css(paint)} ${from}% ${to}%`;
    from = to;
    return stop;
  });
  td.style.background = stops.length > 1 ? `linear-gradient(90deg, ${stops})` : "";
  if (stops.length === 1) td.style.background = css(paints[0]);
  td.classList.toggle("split", stops.length > 1);
  td.style.color = stops.length === 1 ? ink(paints[0]) : "";
}

/** The words of a cell, those of the colored output bold. */
function write(box, pieces, output) {
  const known = JSON.stringify([pieces, output]);
  if (box.dataset.known === known) return;
  box.dataset.known = known;
  box.replaceChildren(
    ...pieces.map((piece) => {
      if (piece.tail) return html("small", {}, piece.text);
      return piece.output === output ? html("b", {}, piece.text) : piece.text;
    }),
  );
}

function sentence(text) {
  const whole = text[0].toUpperCase() + text.slice(1);
  return /[.!?]$/.test(whole) ? whole : `${whole}.`;
}

function spoken({ name }, rule, strength, complaint) {
  const fires = strength ? `, fires with ${strength.toFixed(2)}` : "";
  return `${name}: ${rule.text}${fires}${complaint ? `. ${complaint}` : ""}`;
}

/** Redraw a part of the page; the control that had the focus has it again. */
function keepFocus(part, redraw) {
  const controls = () => [...part.querySelectorAll("button, input")];
  const at = controls().indexOf(document.activeElement);
  redraw();
  if (at >= 0) controls()[at]?.focus();
}

/** The table as the text of an SVG file, as it is on the page. */
function tableFile(grid) {
  const box = grid.getBoundingClientRect();
  const font = getComputedStyle(grid).fontFamily;
  const pen = new SvgPen(Math.ceil(box.width), Math.ceil(box.height), token("--panel"), font);
  for (const cell of grid.querySelectorAll("th, td")) {
    const { left, top, width, height } = cell.getBoundingClientRect();
    const [x, y] = [left - box.left, top - box.top];
    const { color: fill, backgroundColor } = getComputedStyle(cell);
    pen.polygon([x, y, x + width, y, x + width, y + height, x, y + height], backgroundColor);
    pen.text(x + width / 2, y + height / 2, cell.textContent, { fill, align: "middle", size: 12 });
  }
  return pen.file();
}
