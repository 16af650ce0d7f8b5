/* Below the rules: the chosen rule and all words that it could say; rules are added and removed. */

import { color, css, ink, shareOf } from "./colors.js";
import { ask } from "./dialogs.js";
import { check, html, select } from "./elements.js";
import { icon } from "./icons.js";
import { typed } from "./numbers.js";
import { consequents, isOfText, outputsOf, variable, withConfidence, withShare, withWord } from "./rulebase.js";
import { textLink } from "./textlink.js";

/** Show the words of the rule in a slot, or what to do first; `change(slot, text)` edits a rule. */
export function showWords(element, app, slot, change) {
  const { rulebase } = app.store.now.state;
  const isList = rulebase.rules.form === "list";
  if (!slot) {
    const [one, place] = isList ? ["rule", "its last column"] : ["cell", "the cell"];
    const hint = html("p", { class: "hint" }, `Choose a ${one}, then its words here; or type in ${place}.`);
    element.replaceChildren(hint, ...(isList ? [adder(app)] : []));
    return;
  }
  const rule = slot.rule(rulebase.rules);
  const where = html("div", { class: "where" }, html("b", {}, slot.name), html("span", { class: "mono" }, rule.text));
  if (isOfText(rule)) {
    const why = html("p", { class: "note" }, "A rule with 'or' is edited in the ", textLink(app, "text", rule.line), ".");
    element.replaceChildren(where, why, adder(app));
    return;
  }
  element.replaceChildren(
    where,
    ...(rule.together > 1
      ? [
          html("p", { class: "note" }, `${rule.together} rules have this conclusion, and change together; `,
            "they are parted in the ", textLink(app, "text", rule.line), "."),
        ]
      : []),
    ...outputsOf(rulebase).map((name) => row(app, slot, rule, variable(rulebase, name), change)),
    html(
      "div",
      { class: "word-row" },
      html("span", { class: "name" }, "confidence"),
      sureBox(app, slot, rule),
      html("span", { class: "space" }),
      check("several", app.store.now.several, (on) => app.store.set({ several: on }),
        "A word is said besides the others, or no longer; as with Shift"),
      isList ? [adder(app), remover(app, slot)] : symmetry(app),
    ),
  );
}

function symmetry({ store }) {
  return check("symmetric", store.now.symmetric, (on) => store.set({ symmetric: on }),
    "Give the cell mirrored through the middle of the table the same words");
}

function row(app, slot, rule, target, change) {
  const { store } = app;
  const parts = consequents(rule, target.name);
  const said = parts.map(({ set }) => set);
  const { rulebase } = store.now.state;
  const outputs = outputsOf(rulebase);
  const chips = target.sets.map(({ name }) => {
    const paint = color(store.now.palette, shareOf(target, name));
    const chip = html(
      "button",
      {
        type: "button",
        class: "chip",
        "aria-pressed": String(said.includes(name)),
        title: "With Shift besides the other words",
        onclick: ({ shiftKey }) =>
          change(
            slot,
            shiftKey || store.now.several
              ? withShare(rule, outputs, target.name, name, rulebase.rules.form)
              : withWord(rule, outputs, target.name, name),
          ),
      },
      name,
    );
    chip.style.setProperty("--paint", css(paint));
    chip.style.setProperty("--on-paint", ink(paint));
    return chip;
  });
  return html(
    "div",
    { class: "word-row", role: "group", "aria-label": target.name },
    html("span", { class: "name", title: target.label }, target.name),
    html("div", { class: "chips" }, chips),
    rule.weight === null ? shares(app, parts, (part, sure) => change(slot, withConfidence(rule, outputs, part, sure))) : null,
  );
}

/** The confidence of each of the words that a rule says of an output. */
function shares(app, parts, send) {
  return html(
    "div",
    { class: "shares" },
    parts.map((part) =>
      html("label", {}, html("span", {}, part.set), shareBox(app, part, (sure) => send(part, sure))),
    ),
  );
}

function shareBox({ say }, { output, set, confidence }, send) {
  const box = html("input", {
    type: "text",
    inputmode: "decimal",
    class: "number",
    size: 4,
    "aria-label": `Confidence of ${output} ${set}, from 0 to 1`,
    onchange: () => {
      const sure = typed(box.value);
      if (sure >= 0 && sure <= 1) send(sure);
      else {
        say("Confidence: type a number from 0 to 1.", "error");
        box.value = String(confidence);
      }
    },
  });
  box.value = String(confidence);
  return box;
}

function sureBox({ store, edit, say }, slot, rule) {
  const box = html("input", {
    type: "text",
    inputmode: "decimal",
    class: "number",
    size: 5,
    "aria-label": "Confidence of the rule, from 0 to 1",
    onchange: () => {
      const weight = typed(box.value);
      const place = slot.place.rule === undefined ? slot.place : { index: slot.place.rule };
      const symmetric = store.now.symmetric && slot.place.rule === undefined;
      if (weight >= 0 && weight <= 1) edit("set_weight", { ...place, weight, symmetric });
      else say("Confidence: type a number from 0 to 1.", "error");
    },
  });
  box.value = rule.weight === null ? "several" : String(rule.weight);
  return box;
}

// ---------------------------------------------------------------------- rules of a list

function remover({ edit, store }, slot) {
  const remove = async () => {
    if (await edit("remove_rule", { index: slot.place.rule })) store.set({ cell: null });
  };
  const name = { title: "Remove this rule", "aria-label": "Remove this rule" };
  return html("button", { type: "button", ...name, onclick: remove }, icon("remove"), "rule");
}

function adder(app) {
  const name = { title: "Add a rule", "aria-label": "Add a rule" };
  return html("button", { type: "button", ...name, onclick: () => compose(app) }, icon("add"), "rule");
}

/** Ask for the conditions and the conclusion of a new rule. */
function compose({ edit, store }) {
  const { inputs, outputs } = store.now.state.rulebase;
  const [conditions, conclusions] = [{}, {}];
  const line = (into, word, none) => ({ name, sets }) => {
    const options = [["", none], ...sets.map((one) => [one.name, one.name])];
    const choose = select(`${word} ${name}`, options, "", (set) => (into[name] = set));
    return html("label", { class: "line-of-rule" }, html("span", {}, `${word} ${name} is`), choose);
  };
  const chosen = (all) => Object.entries(all).filter(([, set]) => set);
  ask(
    "A new rule",
    [...inputs.map(line(conditions, "if", "any")), ...outputs.map(line(conclusions, "then", "not said"))],
    [
      [
        "Add the rule",
        async () => {
          const then = chosen(conclusions).map(([output, set]) => ({ output, set }));
          const added = await edit("add_rule", { if: Object.fromEntries(chosen(conditions)), then });
          if (added) store.set({ cell: String(store.now.state.rulebase.rules.rules.length - 1) });
        },
      ],
    ],
  );
}
