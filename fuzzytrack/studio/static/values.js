/* The values of the surface that is shown: asked for after every change, kept in the store. */

import { axesOf, drawable } from "./rulebase.js";

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
    const axes = axesOf(rulebase, now.axes);
    const points = dragging ? Math.min(now.points, COARSE) : now.points;
    const args = { outputs: [shown], columns: points, against };
    if (rulebase.inputs.length > 2) {
      args.inputs = axes.map(({ name }) => name);
      args.at = others(rulebase, axes, point);
    }
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

  const keys = ["state", "shown", "against", "axes", "points", "dragging", "point", "connected"];
  store.follow(keys, ask);
  store.follow(["connected"], ({ connected }) => {
    if (!connected) asked = "";
  });
}

/** The other inputs are where the explained point is, or in the middle. */
function others({ inputs }, axes, point) {
  return Object.fromEntries(
    inputs
      .filter((one) => !axes.includes(one))
      .map(({ name, universe: [low, high] }) => [name, point?.[name] ?? (low + high) / 2]),
  );
}
