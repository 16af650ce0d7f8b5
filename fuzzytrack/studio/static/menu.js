/* A button that opens a menu: arrow keys, Enter and Esc as in any program. */

import { html } from "./elements.js";
import { icon } from "./icons.js";

/**
 * A menu button. `items()` gives its entries when it opens: {text, note, run}, or {heading}.
 */
export function menu(name, content, items, attributes = {}) {
  const list = html("div", { class: "menu", role: "menu", popover: "auto", "aria-label": name });
  const button = html(
    "button",
    { type: "button", "aria-haspopup": "menu", "aria-expanded": "false", title: name, ...attributes },
    content,
  );
  if (button.textContent.trim()) button.append(icon("down"));
  else button.setAttribute("aria-label", name);

  function entries() {
    return [...list.querySelectorAll("[role=menuitem]")];
  }

  function fill() {
    list.replaceChildren(
      ...items().map(({ heading, text, note, run }) =>
        heading
          ? html("div", { class: "heading", role: "presentation" }, heading)
          : html(
              "button",
              {
                type: "button",
                role: "menuitem",
                tabindex: -1,
                onclick: () => {
                  list.hidePopover();
                  button.focus();
                  run();
                },
              },
              html("span", {}, text),
              note ? html("kbd", {}, note) : null,
            ),
      ),
    );
  }

  function place() {
    const box = button.getBoundingClientRect();
    const left = Math.min(box.left, innerWidth - list.offsetWidth - 8);
    const below = innerHeight - box.bottom - 12;
    list.style.left = `${Math.max(8, left)}px`;
    list.style.top = `${box.bottom + 4}px`;
    list.style.maxHeight = `${below}px`;
  }

  button.addEventListener("click", () => {
    fill();
    list.togglePopover();
  });
  button.addEventListener("keydown", (event) => {
    if (event.key !== "ArrowDown") return;
    event.preventDefault();
    button.click();
  });
  list.addEventListener("toggle", (event) => {
    const open = event.newState === "open";
    button.setAttribute("aria-expanded", String(open));
    if (!open) return;
    place();
    entries()[0]?.focus();
  });
  list.addEventListener("keydown", (event) => {
    const all = entries();
    const at = all.indexOf(document.activeElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: -1 }[event.key];
    if (event.key === "Tab") list.hidePopover();
    if (event.key === "Escape") button.focus();
    if (to === undefined) return;
    event.preventDefault();
    all.at(to % all.length).focus();
  });
  return html("span", { class: "menu-holder" }, button, list);
}
