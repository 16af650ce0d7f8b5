/* Fields of forms: a number or a text with its name and unit, sent when it is left or on Enter. */

import { html } from "./elements.js";
import { shown, typed } from "./numbers.js";

let made = 0;

/** A number; `change(value)` hears of a new one, null if the field may be `empty`. `show(value)` shows one. */
export function numberField(
  label,
  unit,
  change,
  { least = -Infinity, whole = false, title = "", empty = false } = {},
) {
  const id = `field-${(made += 1)}`;
  const input = html("input", {
    id,
    type: "text",
    class: "number",
    inputmode: "decimal",
    autocomplete: "off",
    title,
  });
  let current = null;
  const limit = Number.isFinite(least) ? ` of at least ${least}` : "";
  const expected = `a ${whole ? "whole " : ""}number${limit}${empty ? ", or nothing" : ""}`;

  function leave() {
    if (input.value === written(current)) return;
    const none = empty && input.value.trim() === "";
    const value = none ? null : typed(input.value);
    const wrong = !none && (!Number.isFinite(value) || value < least || (whole && !Number.isInteger(value)));
    input.setAttribute("aria-invalid", String(wrong));
    if (wrong) {
      input.setCustomValidity(`Type ${expected}, or press Esc.`);
      input.reportValidity();
      return;
    }
    current = value;
    change(value);
  }

  function show(value) {
    current = value ?? null;
    input.removeAttribute("aria-invalid");
    if (document.activeElement !== input || input.value === "") input.value = written(current);
  }

  input.addEventListener("input", () => input.setCustomValidity(""));
  input.addEventListener("change", leave);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      event.preventDefault();
      input.value = written(current);
      input.setCustomValidity("");
      input.removeAttribute("aria-invalid");
    }
    if (event.key !== "Enter") return;
    event.preventDefault();
    leave();
  });
  const [nameShown, unitShown] = [html("label", { for: id }, label), html("span", { class: "unit" }, unit)];
  const element = html(
    "div",
    { class: "field" },
    nameShown,
    html("span", { class: "with-unit" }, input, unitShown),
  );

  /** Let the field be another number. */
  function name(text, measure, help) {
    nameShown.textContent = text;
    unitShown.textContent = measure;
    input.title = help;
  }

  return { element, input, show, name };
}

/** A text; `change(text)` hears of a new one. */
export function textField(label, placeholder, change, title = "") {
  const input = html("input", {
    type: "text",
    placeholder,
    title,
    spellcheck: "false",
    autocomplete: "off",
    onchange: () => change(input.value.trim()),
  });
  const show = (text) => {
    if (document.activeElement !== input) input.value = text ?? "";
  };
  return { element: html("label", { class: "field" }, html("span", { class: "label" }, label), input), show };
}

/** A number, the name of a column, or several of either; `change` hears null if it is empty. */
export function numberOrColumn(columns, change) {
  const id = `field-${(made += 1)}`;
  const input = html("input", {
    id,
    type: "text",
    list: columns,
    spellcheck: "false",
    autocomplete: "off",
    onchange: () => {
      // A comma within a number is a decimal one.
      const words = Number.isFinite(typed(input.value)) ? [input.value] : input.value.split(/[,;]/);
      const values = words.map((word) => (Number.isFinite(typed(word)) ? typed(word) : word.trim()));
      change(input.value.trim() === "" ? null : values.length > 1 ? values : values[0]);
    },
  });
  const [nameShown, unitShown] = [html("label", { for: id }), html("span", { class: "unit" })];
  const show = (value) => {
    const word = (each) => (typeof each === "number" ? written(each) : (each ?? ""));
    if (document.activeElement !== input || input.value === "") input.value = [value].flat().map(word).join(", ");
  };
  function name(text, measure, help) {
    nameShown.textContent = text;
    unitShown.textContent = measure;
    input.title = help;
  }
  const element = html("div", { class: "field" }, nameShown, html("span", { class: "with-unit" }, input, unitShown));
  return { element, input, show, name };
}

/** A group of fields under a heading. */
export function group(heading, ...children) {
  return html("section", { class: "group" }, html("h3", {}, heading), ...children);
}

/** A button that does something that takes a while; it cannot be pressed twice. */
export function action(text, run, attributes = {}) {
  const button = html(
    "button",
    {
      type: "button",
      ...attributes,
      onclick: async () => {
        if (button.getAttribute("aria-disabled") === "true") return;
        button.setAttribute("aria-disabled", "true");
        try {
          await run();
        } finally {
          button.removeAttribute("aria-disabled");
        }
      },
    },
    text,
  );
  return button;
}

function written(value) {
  return value === null || value === undefined ? "" : shown(value, 8);
}
