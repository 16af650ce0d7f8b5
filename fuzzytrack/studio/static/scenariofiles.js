/* Opening and saving of scenarios: those that are shipped, and files of the folder. */

import { html } from "./elements.js";
import { ask } from "./dialogs.js";
import { menu } from "./menu.js";
import { download } from "./pictures.js";

/** A menu of all scenarios. */
export function openScenario({ store, scenario, say }) {
  const opened = html("span", {}, "Scenario");

  store.follow(["scenario"], ({ scenario: now }) => {
    if (now) opened.textContent = now.saved ? now.name : `${now.name} (changed)`;
  });

  async function open(name) {
    const changed = !store.now.scenario.saved;
    if (!(await scenario.change("open_scenario", { name }))) return;
    say(changed ? `${name} is open; undo brings the changed scenario back.` : `${name} is open.`);
  }

  return menu("Open a scenario", [html("span", { class: "unseen" }, "Scenario "), opened], () => {
    const { hello, files } = store.now;
    const own = files.filter(({ kind }) => kind === "scenario");
    return [
      ...(own.length ? [{ heading: "In the folder" }] : []),
      ...own.map(({ name }) => ({ text: name, run: () => open(name) })),
      { heading: "Shipped" },
      ...hello.scenarios.map(({ name, source }) => ({ text: name, note: noteOf(source), run: () => open(name) })),
    ];
  });
}

/** Where a scenario is from, without its remarks; empty if it is ours. */
function noteOf(source) {
  return source === "fuzzytrack" ? "" : source.split(/[;,] (?=the |what |whose |where )/)[0];
}

/** A menu to keep the scenario. */
export function saveScenario({ store, scenario, socket, say }) {
  function saveAs() {
    const { name, file } = store.now.scenario;
    const box = html("input", { type: "text", spellcheck: "false", "aria-label": "Name of the file" });
    box.value = file ?? `${name}-own.yaml`;
    ask("Save the scenario in the folder", [box], [["Save", () => saveTo(box.value.trim(), false)]]);
    box.focus();
  }

  async function saveTo(file, overwrite) {
    try {
      scenario.take((await socket.send("save_scenario", { name: file, overwrite })).state);
      say(`Saved as ${store.now.scenario.name}.`);
      store.set({ files: (await socket.send("files")).files });
    } catch (error) {
      if (overwrite) say(error.message, "error");
      else {
        ask(
          "It was not saved",
          [html("p", {}, error.message)],
          [
            ["Save under another name", saveAs],
            ["Overwrite", () => saveTo(file, true)],
          ],
        );
      }
    }
  }

  return menu("Save the scenario", "Save", () => {
    const { name, file, text } = store.now.scenario;
    return [
      ...(file ? [{ text: `Save ${file}`, run: () => saveTo(file, false) }] : []),
      { text: "Save as…", run: saveAs },
      { text: "Download YAML", run: () => download(`${name.replace(/\.ya?ml$/, "")}.yaml`, text) },
    ];
  });
}
