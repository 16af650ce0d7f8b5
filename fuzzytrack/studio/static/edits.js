/* Edits of the rule base: one at a time and in order; of the drafts of a drag only the newest. */

// Enough for the script that measures latencies; older ones are dropped.
const MOST_TIMES = 5000;

/**
 * `edit(command, arguments)` brings true if it was done; a refusal is said, or given to `refused`.
 * `together(state)` brings what the store is to have of a new state.
 */
export function makeEdits(socket, store, say, together) {
  const queue = [];
  const undrawn = [];
  const times = [];
  let busy = false;

  function edit(command, args = {}, refused = (error) => say(error.message, "error")) {
    return new Promise((resolve) => {
      // What comes later than a draft that still waits says all that the draft did.
      while (queue.at(-1)?.args.draft && queue.at(-1).command === command) queue.pop().resolve(false);
      queue.push({ command, args, refused, resolve, sent: performance.now() });
      next();
    });
  }

  async function next() {
    if (busy || !queue.length) return;
    busy = true;
    const { command, args, refused, resolve, sent } = queue.shift();
    try {
      const { state, scenario } = await socket.send(command, args);
      undrawn.splice(0, undrawn.length - MOST_TIMES);
      undrawn.push({ command, sent, answered: performance.now(), version: state.version });
      // Undo and redo may change the scenario too.
      store.set({ ...(await together(state)), ...(scenario ? { scenario } : {}) });
      resolve(true);
    } catch (error) {
      refused(error);
      resolve(false);
    }
    busy = false;
    next();
  }

  /** A surface of this version of the rule base is on the screen. */
  function drawn(version) {
    const now = performance.now();
    while (undrawn.length && undrawn[0].version <= version) {
      const { command, sent, answered } = undrawn.shift();
      times.push({ command, sent, answered, drawn: now, took: now - sent });
    }
    times.splice(0, times.length - MOST_TIMES);
  }

  window.studioTimes = times;
  return { edit, drawn };
}
