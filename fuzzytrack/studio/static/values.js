/* The values of the surface that is shown: asked for after every change, kept in the store. */

import { axesOf, drawable } from "./rulebase.js";

// Points on each axis while a set is dragged, when a new surface comes many times a second.
const COARSE = 41;

// Milliseconds for which a new state waits for its surface, so that both are drawn in one frame.
const SOON = 40;

/**
 * Follow the rule base and what is chosen; `store.values` is what can be drawn. `together(state)`
 * brings the change of the store that belongs to a new state.
 */
export function followValues(socket, store, say) {
  let asked = "";

  /** The change of the store when the surface is there; null if there is nothing to ask for. */
  async function change(now) {
    const { state, shown, against, dragging, point, connected } = now;
    const rulebase = state?.rulebase;
    if (!connected || !drawable(rulebase).includes(shown)) return null;
    const axes = axesOf(rulebase, now.axes);
    const points = dragging ? Math.min(now.points, COARSE) : now.points;
    const args = { outputs: [shown], columns: points, against };
    if (rulebase.inputs.length > 2) {
      args.inputs = axes.map(({ name }) => name);
      args.at = others(rulebase, axes, point);
    }
    // Undo and redo make new versions, so a version tells whether there is something new.
    const wanted = JSON.stringify([state.version, args]);
    if (wanted === asked) return null;
    asked = wanted;
    try {
      const answer = await socket.latest("surface", "surface", args);
      if (!answer) return null;
      const { columns, rows, layers } = answer;
      const about = { version: state.version, output: shown, against, axes };
      return { values: { ...about, columns, rows, heights: layers[0] }, valuesError: null };
    } catch (error) {
      if (!against) return { values: null, valuesError: error.message };
      say(`${error.message} The difference is off now.`, "error");
      return { against: null };
    }
  }

  async function together(state) {
    const coming = change({ ...store.now, state });
    const late = new Promise((resolve) => setTimeout(resolve, SOON, "late"));
    const found = await Promise.race([coming, late]);
    if (found !== "late") return { state, ...found };
    coming.then((later) => later && store.set(later));
    return { state };
  }

  const keys = ["state", "shown", "against", "axes", "points", "dragging", "point", "connected"];
  store.follow(keys, async (now) => {
    const found = await change(now);
    if (found) store.set(found);
  });
  store.follow(["state", "shown"], ({ state, shown }) => {
    const possible = drawable(state?.rulebase);
    if (possible.length && !possible.includes(shown)) store.set({ shown: possible[0] });
  });
  store.follow(["connected"], ({ connected }) => {
    if (!connected) asked = "";
  });
  return together;
}

/** The other inputs are where the explained point is, or in the middle. */
function others({ inputs }, axes, point) {
  return Object.fromEntries(
    inputs
      .filter((one) => !axes.includes(one))
      .map(({ name, universe: [low, high] }) => [name, point?.[name] ?? (low + high) / 2]),
  );
}
