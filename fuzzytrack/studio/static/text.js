/* The YAML of the rule base as text: line numbers, colors of words, complaints at their lines. */

import { html } from "./elements.js";

export const title = "Text";
// A pause in typing after which the text is sent.
const PAUSE = 350;

export function mount(element, app) {
  const { store } = app;
  const numbers = html("div", { class: "numbers", "aria-hidden": "true" });
  const colored = html("pre", { class: "colored", "aria-hidden": "true" });
  const area = html("textarea", {
    spellcheck: "false",
    autocapitalize: "off",
    autocomplete: "off",
    wrap: "off",
    "aria-label": "YAML of the rule base",
    "aria-describedby": "text-complaints",
  });
  const complaints = html("div", { class: "complaints", id: "text-complaints", "aria-live": "polite" });
  let timer = 0;
  let sent = null;

  element.append(
    html("header", {}, html("h2", {}, "Rules"), app.tabs(), html("span", { class: "space" })),
    html("div", { class: "editor" }, numbers, html("div", { class: "page" }, colored, area)),
    complaints,
  );

  async function send() {
    clearTimeout(timer);
    timer = 0;
    const { text } = store.now.state;
    if (area.value === withoutReturns(text)) return;
    // A text area has no carriage returns; a file that has them keeps them.
    sent = text.includes("\r\n") ? area.value.replaceAll("\n", "\r\n") : area.value;
    await app.edit("set_text", { text: sent });
    sent = null;
  }

  function paint() {
    const lines = area.value.split("\n");
    const marked = new Set(store.now.state?.complaints.map(({ line }) => line));
    colored.replaceChildren(...lines.flatMap((line) => [...words(line), "\n"]));
    numbers.replaceChildren(
      ...lines.map((_, k) => html("span", { class: marked.has(k + 1) ? "marked" : null }, String(k + 1))),
    );
    scroll();
  }

  function scroll() {
    numbers.scrollTop = area.scrollTop;
    colored.scrollTop = area.scrollTop;
    colored.scrollLeft = area.scrollLeft;
  }

  function goTo(line, column) {
    const lines = area.value.split("\n");
    const start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0) + column - 1;
    area.focus();
    area.setSelectionRange(start, start);
    const height = area.scrollHeight / lines.length;
    area.scrollTop = Math.max(0, (line - 4) * height);
  }

  area.addEventListener("input", () => {
    paint();
    clearTimeout(timer);
    timer = setTimeout(send, PAUSE);
  });
  area.addEventListener("blur", () => timer && send());
  area.addEventListener("scroll", scroll);
  area.addEventListener("keydown", (event) => {
    // Tab leaves the field, as everywhere on the page; Esc is a way back to the table.
    if (event.key === "Escape") {
      app.show({ tab: "table" });
      document.querySelector('#pane-rules td[tabindex="0"]')?.focus();
    }
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      // The undo of the page, which knows of the table and the sets too, not that of the field.
      event.preventDefault();
      event.stopPropagation();
      send().then(() => app.edit(event.shiftKey ? "redo" : "undo"));
    }
  });

  store.follow(["state", "tab", "line"], ({ state, tab, line }) => {
    if (!state || tab !== "text") return;
    // What is being typed is newer than the answer to what was typed before.
    const text = withoutReturns(state.text);
    if (!timer && sent === null && area.value !== text) {
      const { selectionStart, selectionEnd, scrollTop } = area;
      area.value = text;
      area.setSelectionRange(selectionStart, selectionEnd);
      area.scrollTop = scrollTop;
    }
    paint();
    complaints.replaceChildren(...complaintRows(state.complaints, (place) => goTo(place.line, place.column)));
    if (!line) return;
    store.set({ line: null });
    // The pane is shown by those that hear of the tab after this.
    requestAnimationFrame(() => goTo(line.line, line.column));
  });
}

/** Complaints, each with a button that goes to its place, below what they mean for the pictures. */
export function complaintRows(complaints, go) {
  const stale = complaints.some(({ stops }) => stops)
    ? [html("p", { class: "complaint" }, "The text does not load: table and pictures are of the last one that did.")]
    : [];
  return [...stale, ...complaints.map((one) => complaintRow(one, () => go(one)))];
}

function complaintRow({ message, line, column }, go) {
  const place = line ? `${line}:${column}` : "here";
  return html(
    "div",
    { class: "complaint" },
    html("button", { type: "button", class: "link mono", title: "Go to the place", onclick: go }, place),
    html("span", {}, message),
  );
}

function withoutReturns(text) {
  return text.replaceAll("\r\n", "\n");
}

/** The words of a line of YAML, each with the color of its kind. */
function words(line) {
  const parts = [];
  const pattern = /(#.*$)|("[^"]*"|'[^']*')|([&*][\w-]+)|([\w.-]+)(?=\s*:(?:\s|$))|(?<![\w-])(-?\d[\d.eE+-]*)/g;
  const kinds = [null, "comment", "string", "anchor", "key", "number"];
  let last = 0;
  for (const match of line.matchAll(pattern)) {
    const kind = match.slice(1).findIndex((part) => part !== undefined) + 1;
    // A sign that starts a comment needs a space before it.
    if (kind === 1 && match.index && !/\s/.test(line[match.index - 1])) continue;
    parts.push(line.slice(last, match.index), html("span", { class: kinds[kind] }, match[0]));
    last = match.index + match[0].length;
  }
  parts.push(line.slice(last));
  return parts.filter((part) => part !== "");
}
