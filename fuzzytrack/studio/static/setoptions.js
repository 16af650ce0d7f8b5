/* How sets are dragged: the grid, neighbors and mirror images that move along, sets that are shared. */

import { currentVariable } from "./chosenset.js";
import { check, html, select } from "./elements.js";
import { keepFocus } from "./focus.js";
import { shown } from "./numbers.js";

/** Make the options; `show()` shows them as the store has them. */
export function setOptions(app) {
  const { store } = app;
  const element = html("div", { class: "tools" });

  function show() {
    const isLinkable = app.can("set_shapes");
    const { snap, linked, mirror, shared } = store.now;
    const target = currentVariable(store.now);
    const [low, high, points] = target.universe;
    const grid = shown((high - low) / Math.max(1, points - 1), 3);
    const others = target.shared_with.join(" and ");
    // A drag changes the state many times a second, and the options hardly ever.
    const known = JSON.stringify([target.name, others, grid, snap, linked, mirror, shared, isLinkable]);
    if (element.dataset.known === known) return;
    element.dataset.known = known;
    const controls = [
      select(
        "Snap",
        [["grid", `snap ${grid}`], ["fine", `snap ${shown((high - low) / 200, 3)}`], ["off", "no snap"]],
        snap,
        (value) => store.set({ snap: value }),
      ),
      ...(isLinkable
        ? [
            check("linked", linked, (on) => store.set({ linked: on }),
              "Corners of neighbors at the same place move along"),
            check("mirrored", mirror, (on) => store.set({ mirror: on }),
              "The set mirrored about the middle changes likewise"),
          ]
        : []),
      ...(others
        ? [
            select(
              `${target.name} has the same sets as ${others}: what a change is for`,
              [["both", `${target.name} and ${others}`], ["apart", `${target.name} alone`]],
              shared,
              (value) => store.set({ shared: value }),
            ),
          ]
        : []),
    ];
    keepFocus(element, () => element.replaceChildren(...controls));
  }

  return { element, show };
}
