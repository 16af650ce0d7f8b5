/* The bar at the top: the name of the rule base, open, save, undo, redo, export, looks, help. */

import { PALETTES } from "./colors.js";
import { ask } from "./dialogs.js";
import { html } from "./elements.js";
import { enable, goByArrows, isEnabled } from "./focus.js";
import { icon } from "./icons.js";
import { menu } from "./menu.js";
import { download } from "./pictures.js";

const KEYS = [
  ["Ctrl S", "save"],
  ["Ctrl O", "open"],
  ["Ctrl Z, Ctrl Shift Z", "undo, redo"],
  ["Arrows", "move in the table; turn the surface; move the point in the contours"],
  ["Enter, F2 or a letter", "type in a cell; Enter keeps it, Esc leaves it"],
  ["+ and −", "next and previous set of the colored output in a cell; zoom of the surface"],
  ["Shift click or Shift Enter on a word", "the rule says it besides the others, which share it"],
  ["Arrows on a corner of a set, or on its square", "move the corner or the set, with Shift ten times as far; Esc takes it back"],
  ["Alt while dragging", "no snapping"],
  ["Shift Arrows on the surface", "move the explained point"],
  ["Ctrl Enter", "run the experiment"],
  ["Arrows on a way-point", "move it, with Shift ten times as far; Delete removes it"],
  ["+, − and 0 on a map", "zoom, and show the whole track; arrows move the map"],
  ["Arrows and Space on a map", "while way-points are drawn or distances measured: move the cross, and click there"],
  ["Esc in a field", "take back what was typed"],
  ["?", "these keys"],
];

export function mount(element, app) {
  const { store, socket, say } = app;
  const name = html("button", { type: "button", class: "name", title: "Save under a name", onclick: saveAs });
  const saved = html("span", { class: "saved" });
  const undo = tool("undo", "Undo (Ctrl Z)", () => app.edit("undo"));
  const redo = tool("redo", "Redo (Ctrl Shift Z)", () => app.edit("redo"));

  element.append(
    html("h1", {}, "fuzzytrack ", html("span", {}, "studio")),
    html("span", { class: "document" }, name, saved),
    tool("open", "Open (Ctrl O)", open, "Open"),
    tool("save", "Save (Ctrl S)", save, "Save"),
    undo,
    redo,
    html("span", { class: "space" }),
    menu("Export", html("span", {}, "Export"), exports),
    menu("Colors and brightness", icon("scheme"), looks, { class: "quiet" }),
    tool("help", "Keys (?)", help),
  );

  function tool(picture, title, run, text) {
    const attributes = { type: "button", title, "aria-label": text ? null : title, class: text ? null : "quiet" };
    const button = html("button", { ...attributes, onclick: () => isEnabled(button) && run() }, icon(picture), text);
    return button;
  }

  // ------------------------------------------------------------------ open and save

  async function open() {
    const list = html("div", { class: "entries" });
    const choose = () => {
      for (const one of list.children) one.hidden = !one.textContent.includes(filter.value);
    };
    const filter = html("input", {
      type: "search",
      placeholder: "Filter",
      "aria-label": "Filter the names",
      oninput: choose,
      onkeydown: async (event) => {
        if (!["Enter", "ArrowDown"].includes(event.key)) return;
        event.preventDefault();
        await filled;
        const left = [...list.children].filter((one) => !one.hidden);
        const first = left.find((one) => one.firstChild.textContent === filter.value) ?? left[0];
        if (event.key === "Enter") first?.click();
        else first?.focus();
      },
    });
    const { state } = store.now;
    const words = "What is open has changes that are not saved. They stay in undo.";
    const warning = state && !state.saved ? html("p", { class: "warning" }, words) : null;
    // At once, so that keys that follow are typed here and not into the table.
    const dialog = ask("Open a rule base", [filter, warning, list], []);
    filter.focus();
    const filled = entries(dialog).then((found) => {
      list.append(...found);
      goByArrows(list);
      choose();
    });
    await filled;
  }

  /** Buttons for what can be opened: of the folder, drafts and shipped ones. */
  async function entries(dialog) {
    const { drafts } = await socket.send("drafts");
    store.set(await socket.send("files"));
    const { files, shipped } = store.now;
    const entry = (title, kind, command, values, done) =>
      html(
        "button",
        {
          type: "button",
          class: "entry",
          onclick: async () => {
            dialog.close();
            if (await app.edit(command, values)) say(done);
          },
        },
        html("span", {}, title),
        html("small", {}, kind),
      );
    const rules = (name, kind) => entry(name, kind, "open", { name }, `${name} is open.`);
    return [
      ...files.filter(({ kind }) => kind === "rules").map(({ name: one }) => rules(one, "in the folder")),
      ...drafts.map((one) =>
        entry(
          `${one.rules}, scenario ${one.scenario}`,
          `draft, not saved, ${new Date(1000 * one.time).toLocaleString()}`,
          "restore",
          { key: one.key },
          `The draft of ${one.rules} is open; undo takes it back.`,
        ),
      ),
      ...shipped.map((one) => rules(one, "shipped")),
    ];
  }

  async function save() {
    const { file } = store.now.state;
    if (!file) saveAs();
    else await saveTo(file, false);
  }

  function saveAs() {
    const { state } = store.now;
    const box = html("input", { type: "text", spellcheck: "false", "aria-label": "Name of the file" });
    box.value = state.file ?? `${state.name}.yaml`;
    ask("Save the rule base in the folder", [box], [
      ["Save", () => saveTo(box.value.trim(), false)],
    ]);
    box.focus();
    box.setSelectionRange(0, box.value.replace(/\.ya?ml$/, "").length);
  }

  async function saveTo(file, overwrite) {
    const done = await app.edit("save", { name: file, overwrite }, async ({ message }) => {
      // Another page may have made it meanwhile.
      store.set(await socket.send("files"));
      const { files, state } = store.now;
      const there = file === state.file || files.some(({ name: one }) => one === file);
      if (overwrite || !there) say(message, "error");
      else {
        ask("It was not saved", [html("p", {}, message)], [
          ["Replace it", () => saveTo(file, true)],
          ["Save under another name", saveAs],
        ]);
      }
    });
    if (!done) return;
    say(`Saved as ${store.now.state.file}.`);
    store.set(await socket.send("files"));
  }

  // ------------------------------------------------------------------ menus

  function exports() {
    const { state } = store.now;
    const file = state.file ?? `${state.name}.yaml`;
    const asked = [
      ["snippet", { what: "python" }, "Python of the experiment"],
      ["snippet", { what: "command" }, "Command of the experiment"],
      ["report", {}, "Report (HTML)"],
    ];
    return [
      { text: "YAML", note: file, run: () => download(file, state.text, "application/yaml") },
      ...asked
        .filter(([command]) => app.can(command))
        .map(([command, args, text]) => ({ text, run: () => keepText(app, command, args, text) })),
    ];
  }

  function looks() {
    const { palette } = store.now;
    const mark = (text, chosen) => (chosen ? `${text} ✓` : text);
    return [
      { heading: "Brightness" },
      ...["as the system", "light", "dark"].map((one, k) => {
        const value = k ? one : null;
        return { text: mark(one, app.wantedScheme() === value), run: () => app.setScheme(value) };
      }),
      { heading: "Colors of values" },
      ...PALETTES.map((one) => ({ text: mark(one, palette === one), run: () => store.set({ palette: one }) })),
    ];
  }

  function help() {
    const rows = KEYS.map(([keys, text]) => html("tr", {}, html("th", { scope: "row" }, html("kbd", {}, keys)), html("td", {}, text)));
    ask("Keys", [html("table", { class: "keys" }, html("tbody", {}, rows))], []);
  }

  store.follow(["state"], ({ state }) => {
    if (!state) return;
    name.textContent = state.name;
    saved.textContent = state.saved ? (state.file ? "saved" : "as shipped") : "not saved";
    saved.classList.toggle("changed", !state.saved);
    enable(undo, state.undo);
    enable(redo, state.redo);
    document.title = `${state.saved ? "" : "• "}${state.name} – fuzzytrack studio`;
  });

  return { open, save, help };
}

/** Ask the server for a text that keeps what is on screen; a report becomes a file, others are shown. */
export async function keepText({ socket, say }, command, args, heading) {
  try {
    const { name, text } = await socket.send(command, args);
    if (command === "report") download(name, text, "text/html");
    else showText(say, heading, text);
  } catch (error) {
    say(error.message, "error");
  }
}

function showText(say, heading, text) {
  ask(heading, [html("pre", { class: "snippet", tabindex: 0 }, text)], [
    [
      "Copy",
      () => navigator.clipboard.writeText(text).then(
        () => say("Copied."),
        () => say("The browser does not let the page copy: select the text and press Ctrl C.", "error"),
      ),
    ],
  ]);
}
