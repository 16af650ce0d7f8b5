/* The values of the surface that is shown: asked for after every change, kept in the store. */

import { drawable } from "./rulebase.js";

// Points on each axis while a set is dragged, when a new surface comes many times a second.
const COARSE = 41;

/** Follow the rule base and what is chosen; `store.values` is what can be drawn. */
export function followValues(app) {
  const { socket, store, say } = app;
  let asked = "";

  async function ask(now) {
    const { state, shown, against, dragging, point, connected } = now;
    const rulebase = state?.rulebase;
    if (!rulebase || !connected) return;
    const possible = drawable(rulebase);
    if (!possible.includes(shown)) {
      store.set({ shown: possible[0] });
      return;
    }
    const axes = rulebase.inputs.slice(0, 2);
    const points = dragging ? Math.min(now.points, COARSE) : now.points;
    const args = { outputs: [shown], columns: points, against };
    if (rulebase.inputs.length > 2) args.at = others(rulebase, point);
    // Undo and redo make new versions, so a version tells whether there is something new.
    const wanted = JSON.stringify([state.version, args]);
    if (wanted === asked) return;
    asked = wanted;
    try {
      const answer = await socket.latest("surface", "surface", args);
      if (!answer) return;
      store.set({
        values: {
          version: state.version,
          output: shown,
          against,
          axes,
          columns: answer.columns,
          rows: answer.rows,
          heights: answer.layers[0],
        },
        valuesError: null,
      });
    } catch (error) {
      if (against) {
        say(`${error.message} The difference is off now.`, "error");
        store.set({ against: null });
      } else store.set({ values: null, valuesError: error.message });
    }
  }

  store.follow(["state", "shown", "against", "points", "dragging", "point", "connected"], ask);
  store.follow(["connected"], ({ connected }) => {
    if (!connected) asked = "";
  });
}

function others(rulebase, point) {
  return Object.fromEntries(
    rulebase.inputs.slice(2).map(({ name, universe: [low, high] }) => [
      name,
      point?.[name] ?? (low + high) / 2,
    ]),
  );
}
