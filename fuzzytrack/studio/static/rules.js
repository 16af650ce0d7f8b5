/* The rules: a table of words colored by consequent, or a list; edited cell by cell. */

import {
  listRows, listSlots, placeKey, spoken, tableFile, tableRows, tableSlots, tint, write,
} from "./cells.js";
import { html, select } from "./elements.js";
import { keepFocus } from "./focus.js";
import { pictureMenu } from "./pictures.js";
import { consequents, isOfText, outputsOf, piecesOf, variable, withWord } from "./rulebase.js";
import { complaintRows } from "./text.js";
import { textLink } from "./textlink.js";
import { showWords } from "./words.js";

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
    grid.style.setProperty("--columns", rules.column_sets?.length ?? 0);
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
    const { rulebase } = state;
    if (set && !isOfText(slot.rule(rulebase.rules))) change(slot, withWord(slot.rule(rulebase.rules), outputsOf(rulebase), output, set));
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
    const rule = slot.rule(store.now.state.rulebase.rules);
    if (isOfText(rule)) {
      app.show({ tab: "text", line: { line: rule.line, column: 1 } });
      return;
    }
    const before = rule.text;
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

  function showOperators({ operators: all, outputs }) {
    const own = outputs.filter((output) => output.operators);
    operators.dataset.known = JSON.stringify([all, own]);
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
      ...own.map(({ name, operators: { words: said, line } }) =>
        html("p", { class: "note" }, `${name} has its own: ${said.join(", ")}. `, textLink(app, "text", line)),
      ),
    );
  }

  function goTo({ where, line, column }) {
    const slot = slots.find((one) => one.key === keyOfComplaint(where));
    if (slot) slot.td.focus();
    else if (where?.set) store.set({ variable: where.variable, set: where.set });
    else app.show({ tab: "text", line: line ? { line, column } : null });
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
    const own = rulebase.outputs.filter((output) => output.operators);
    if (JSON.stringify([rulebase.operators, own]) !== operators.dataset.known) {
      keepFocus(operators, () => showOperators(rulebase));
    }
    about.textContent = rulebase.description;
    complaints.replaceChildren(...complaintRows(state.complaints, goTo));
    const outputs = outputsOf(rulebase);
    if (!outputs.includes(store.now.colorBy)) store.set({ colorBy: outputs[0] });
  });
  store.follow(["shown"], ({ state, shown }) => {
    if (state?.rulebase && outputsOf(state.rulebase).includes(shown)) store.set({ colorBy: shown });
  });
  store.follow(["state", "colorBy"], ({ state, colorBy: output }) => {
    const outputs = state?.rulebase ? outputsOf(state.rulebase) : [];
    coloring.hidden = outputs.length < 2;
    const chosen = select(
      "Color cells by",
      outputs.map((name) => [name, `color ${name}`]),
      output,
      (name) => store.set({ colorBy: name }),
    );
    keepFocus(coloring, () => coloring.replaceChildren(chosen));
  });
  store.follow(
    ["state", "colorBy", "palette", "explanation", "cell", "scheme", "symmetric", "several"],
    ({ state, colorBy: output, palette, explanation, cell, scheme, symmetric, several }) => {
      if (!state?.rulebase) return;
      // While a set is dragged the state changes many times a second, and no rule does.
      const { rules, outputs } = state.rulebase;
      const sets = outputs.map((one) => one.sets.map(({ name }) => name));
      const looks = [output, palette, cell, scheme, symmetric, several];
      const now = JSON.stringify([rules, sets, state.complaints, explanation, looks]);
      if (now === painted) return;
      painted = now;
      paint();
      const chosen = slots.find(({ key: one }) => one === cell);
      keepFocus(words, () => showWords(words, app, chosen, change));
    },
  );
}

// ---------------------------------------------------------------------- what rules are about

function keyOfComplaint(where) {
  return where?.cell ? where.cell.join() : String(where?.rule ?? "");
}

function complaintsByKey(complaints) {
  return new Map(complaints.map(({ where, message }) => [keyOfComplaint(where), message]));
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
  return JSON.stringify([inputs.map(({ name }) => name), rules.rules.map((one) => [one.if, one.or])]);
}

function sentence(text) {
  const whole = text[0].toUpperCase() + text.slice(1);
  return /[.!?]$/.test(whole) ? whole : `${whole}.`;
}

