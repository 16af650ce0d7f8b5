/* The scenario on screen, kept in the store and replaced by every change. */

/** `change(command, arguments)` brings true if it was done; a refusal is said. */
export function followScenario({ socket, store, say }) {
  let last = Promise.resolve();
  let draftWaits = null;
  let drafting = false;

  /** Changes are done one after the other: each is told from what the one before it made. */
  function change(command, args = {}) {
    draftWaits = null;
    last = last.then(async () => {
      try {
        take((await socket.send(command, args)).state);
        return true;
      } catch (error) {
        say(error.message, "error");
        // What was typed or dragged goes back to what is true.
        store.set({ scenario: { ...store.now.scenario } });
        return false;
      }
    });
    return last;
  }

  /** A change on the way to another one, as in a drag: one is in flight, the newest waits. */
  async function draft(command, args) {
    draftWaits = { command, args };
    if (drafting) return;
    drafting = true;
    while (draftWaits) {
      const { command: name, args: given } = draftWaits;
      draftWaits = null;
      // What cannot be on the way, such as two points at one place, is refused at the end.
      await socket.send(name, { ...given, draft: true }).then(
        ({ state }) => take(state),
        () => {},
      );
    }
    drafting = false;
  }

  function take(scenario) {
    const { version, undo, redo } = scenario;
    // Both texts share the list of what can be undone.
    store.set({ scenario, state: { ...store.now.state, version, undo, redo } });
  }

  store.follow(["hello"], ({ hello }) => {
    if (hello?.scenario) store.set({ scenario: hello.scenario });
  });
  return { change, draft, take };
}

/** Points of the true track, [x, y] each; the second axis is 0 if there is one only. */
export function truthOf(now) {
  return (now?.scenario?.truth ?? []).map(([x, y = 0]) => [x, y]);
}

/** What the target of a scenario is: "waypoints", "motion", "maneuver", "set" or "other". */
export function targetKind({ target }) {
  return ["waypoints", "motion", "maneuver", "set"].find((key) => target?.[key] !== undefined) ?? "other";
}
