/* Elements of the page, made and named in one call. */

import { goByArrows } from "./focus.js";

const SVG = "http://www.w3.org/2000/svg";

/** An HTML element; attributes starting with "on" are listeners, others that are false are left out. */
export function html(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** An SVG element, likewise. */
export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) {
      element.setAttribute(name, value);
    }
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** A select of [value, text] pairs with a name for screen readers. */
export function select(name, options, value, change, attributes = {}) {
  const element = html(
    "select",
    { "aria-label": name, title: name, ...attributes, onchange: () => change(element.value) },
    options.map(([key, text]) => html("option", { value: key }, text)),
  );
  element.value = value;
  return element;
}

/** A row of buttons of which one is pressed; `show(value)` presses another. */
export function choice(name, change) {
  const element = html("div", { class: "choice", role: "group", "aria-label": name });
  let known = "";
  goByArrows(element);

  function show(options, value) {
    const wanted = JSON.stringify(options);
    if (wanted !== known) {
      known = wanted;
      element.replaceChildren(
        ...options.map(([key, text, title]) =>
          html(
            "button",
            { type: "button", "data-key": key, title, onclick: () => change(key) },
            text,
          ),
        ),
      );
    }
    for (const button of element.children) {
      button.setAttribute("aria-pressed", String(button.dataset.key === value));
    }
  }

  return { element, show };
}

/** A checkbox with its text. */
export function check(text, checked, change, title) {
  const box = html("input", { type: "checkbox", checked, onchange: () => change(box.checked) });
  return html("label", { class: "check", title }, box, html("span", {}, text));
}
