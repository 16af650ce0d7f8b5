/* The scenario on screen, kept in the store and replaced by every change. */

/** `change(command, arguments)` brings true if it was done; a refusal is said. */
export function followScenario({ socket, store, say }) {
  let last = Promise.resolve();

  /** Changes are done one after the other: each is told from what the one before it made. */
  function change(command, args = {}) {
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

  function take(scenario) {
    const { version, undo, redo } = scenario;
    // Both texts share the list of what can be undone.
    store.set({ scenario, state: { ...store.now.state, version, undo, redo } });
  }

  store.follow(["hello"], ({ hello }) => {
    if (hello?.scenario) store.set({ scenario: hello.scenario });
  });
  return { change, take };
}

/** Points of the true track, [x, y] each; the second axis is 0 if there is one only. */
export function truthOf(now) {
  return (now?.scenario?.truth ?? []).map(([x, y = 0]) => [x, y]);
}

/** What the target of a scenario is: "waypoints", "motion", "maneuver", "set" or "other". */
export function targetKind({ target }) {
  return ["waypoints", "motion", "maneuver", "set"].find((key) => target?.[key] !== undefined) ?? "other";
}
