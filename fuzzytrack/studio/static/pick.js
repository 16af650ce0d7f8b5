/* The trackers that are chosen: one a row, with its parameters; added from all that are known. */

import { check, html } from "./elements.js";
import { keepFocus } from "./focus.js";
import { icon } from "./icons.js";
import { menu } from "./menu.js";

// What the rule base on screen is called among trackers, and as it was last saved.
const OWN = [
  ["editor", "the rule base on screen"],
  ["saved", "as it was last saved"],
];

// What `fuzzytrack compare` compares unless it is told others.
const FOR_RECORDINGS = ["maneuver", "fixed:alpha=0.5377:beta=0.2018", "chan-style", "stiffness-damping"];

/** Trackers of a text: its name, and its parameters as [[name, value]]. */
function splitTracker(text) {
  const [name, ...parts] = text.split(":");
  return { name, parameters: parts.map((part) => part.split(/=(.*)/s).slice(0, 2)) };
}

function joined(name, parameters) {
  return [name, ...parameters.filter(([, value]) => value !== "").map((pair) => pair.join("="))].join(":");
}

/** The trackers of recordings until others are chosen. */
export const RECORDED = ["editor", ...FOR_RECORDINGS].map((text) => ({ text, on: true }));

/** Texts of the trackers that are checked in a list of them. */
export function chosenTrackers(trackers) {
  return trackers.filter(({ on }) => on).map(({ text }) => text);
}

/** The list; what the store has as `key` is [{text, on}]. */
export function trackerList({ store }, key) {
  const rows = html("ul", { class: "picks" });
  const element = html(
    "div",
    { class: "chosen-trackers" },
    rows,
    html("div", { class: "actions" }, adder(), menu("Choose many", "Choose", many)),
  );
  const open = new Set();

  function change(trackers) {
    store.set({ [key]: trackers });
  }

  function put(index, part) {
    change(store.now[key].map((each, k) => (k === index ? { ...each, ...part } : each)));
  }

  function add(text) {
    const trackers = store.now[key];
    const known = trackers.findIndex((each) => each.text === text);
    if (known >= 0) put(known, { on: true });
    else change([...trackers, { text, on: true }]);
  }

  function adder() {
    return menu("Add a tracker", [icon("add"), "Add"], () => {
      const { hello, files } = store.now;
      const kinds = [...new Set(hello.trackers.map(({ kind }) => kind))];
      const own = files.filter(({ kind }) => kind === "rules");
      const entry = (name) => ({ text: name, run: () => add(name) });
      return [
        { heading: "On this page" },
        ...OWN.map(([name, note]) => ({ text: name, note, run: () => add(name) })),
        ...(own.length ? [{ heading: "In the folder" }, ...own.map(({ name }) => entry(name))] : []),
        ...kinds.flatMap((kind) => [
          { heading: `${kind[0].toUpperCase()}${kind.slice(1)}s` },
          ...hello.trackers.filter((each) => each.kind === kind).map(({ name }) => entry(name)),
        ]),
      ];
    });
  }

  function many() {
    const { scenario, hello } = store.now;
    const all = (texts) => change(texts.map((text) => ({ text, on: true })));
    const own = scenario?.scenario?.trackers ?? [];
    return [
      { text: "Those of the scenario, and the editor", run: () => all(["editor", ...own]) },
      { text: "Those for recordings, and the editor", run: () => all(["editor", ...FOR_RECORDINGS]) },
      {
        text: "All that are registered",
        run: () => all(["editor", ...hello.trackers.filter(runnable).map(({ name }) => name)]),
      },
      { text: "None", run: () => change(store.now[key].map((each) => ({ ...each, on: false }))) },
    ];
  }

  function rowOf({ text, on }, index) {
    const { name, parameters } = splitTracker(text);
    const known = store.now.hello?.trackers.find((each) => each.name === name);
    const names = known?.parameters ?? [];
    const form = names.length ? formOf(index, name, parameters, names) : null;
    const label = name === "editor" ? `editor: ${store.now.state?.name}` : name;
    const chosen = check(label, on, (value) => put(index, { on: value }), known?.help ?? text);
    const told = parameters.map((pair) => pair.join("=")).join(", ");
    return html(
      "li",
      {},
      html(
        "div",
        { class: "pick" },
        chosen,
        html(
          "button",
          {
            type: "button",
            class: "quiet",
            title: `Remove ${text}`,
            "aria-label": `Remove ${text}`,
            onclick: () => change(store.now[key].filter((_, k) => k !== index)),
          },
          icon("remove"),
        ),
      ),
      form
        ? html(
            "details",
            {
              open: open.has(text),
              ontoggle: (event) => (event.currentTarget.open ? open.add(text) : open.delete(text)),
            },
            html("summary", {}, told || (names.length > 1 ? `${names.length} parameters` : "1 parameter")),
            form,
          )
        : told
          ? html("p", { class: "muted told" }, told)
          : null,
    );
  }

  function formOf(index, name, parameters, names) {
    const given = Object.fromEntries(parameters);
    return html(
      "div",
      { class: "form-grid" },
      names.map((parameter) => {
        const { name: key, default: usual } = parameter;
        const input = html("input", {
          type: "text",
          value: given[key] ?? "",
          placeholder: usual ?? "",
          autocomplete: "off",
          spellcheck: "false",
          onchange: () => {
            const others = parameters.filter(([each]) => each !== key);
            const text = joined(name, [...others, [key, input.value.trim()]]);
            open.add(text);
            put(index, { text });
          },
        });
        return html(
          "label",
          { class: "field", title: parameter.help },
          html("span", { class: "label" }, key),
          input,
        );
      }),
    );
  }

  store.follow([key, "hello", "scenario", "opened"], ({ [key]: trackers, hello }) => {
    if (!hello) return;
    keepFocus(element, () => rows.replaceChildren(...trackers.map(rowOf)));
  });
  return { element };
}

/** Whether a tracker can be run without being told a number. */
function runnable({ parameters }) {
  return parameters.every((each) => each.default !== null);
}
