/* The views of the rail, and the panes that each of them shows; a pane may be in several views. */

import * as contour from "./contour.js";
import * as data from "./data.js";
import { html } from "./elements.js";
import * as explain from "./explain.js";
import { goByArrows } from "./focus.js";
import * as gainplane from "./gainplane.js";
import { icon } from "./icons.js";
import * as results from "./results.js";
import * as rules from "./rules.js";
import * as run from "./run.js";
import * as sets from "./sets.js";
import * as surface from "./surface.js";
import * as text from "./text.js";
import * as tune from "./tune.js";
import * as world from "./world.js";

// Modules of panes by name: each has `title` and `mount(element, app)`.
const PANES = { rules, text, sets, surface, contour, explain, gains: gainplane, world, run, results, data, tune };

const VIEWS = [
  {
    id: "design",
    title: "Rules & sets",
    picture: "table",
    panes: ["rules", "text", "sets", "surface", "explain"],
  },
  {
    id: "surface",
    title: "Surface",
    picture: "surface",
    panes: ["surface", "contour", "gains", "explain"],
  },
  { id: "world", title: "World", picture: "map", panes: ["world"] },
  { id: "run", title: "Run & results", picture: "run", panes: ["run", "results"] },
  { id: "data", title: "Data", picture: "data", panes: ["data", "tune"] },
];

/** Whether a view shows a pane. */
export function isShown(pane, view) {
  return VIEWS.find(({ id }) => id === view).panes.includes(pane);
}

/** Mount the rail and all panes; `store.view` says which of them are shown. */
export function mountViews(rail, main, app) {
  const { store } = app;
  const panes = Object.entries(PANES).map(([name, module]) => {
    const pane = html("section", { class: "pane", id: `pane-${name}`, "aria-label": module.title });
    main.append(pane);
    module.mount(pane, app);
    return [name, pane];
  });
  const buttons = VIEWS.map(({ id, title, picture }) => {
    const open = () => store.set({ view: id });
    return html("button", { type: "button", "data-view": id, onclick: open }, icon(picture), html("span", {}, title));
  });
  rail.append(...buttons);
  goByArrows(rail);

  store.follow(["view", "tab"], ({ view, tab }) => {
    const isAnother = main.dataset.view !== undefined && main.dataset.view !== view;
    main.dataset.view = view;
    for (const [name, pane] of panes) {
      const behind = name === (tab === "text" ? "rules" : "text");
      pane.hidden = behind || !isShown(name, view);
    }
    for (const button of buttons) {
      if (button.dataset.view === view) button.setAttribute("aria-current", "page");
      else button.removeAttribute("aria-current");
    }
    // What had the focus is not shown any more.
    const focused = document.activeElement;
    if (isAnother && (focused === document.body || focused.closest(".pane[hidden]"))) main.focus();
  });
}
