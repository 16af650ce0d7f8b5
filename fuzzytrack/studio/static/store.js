/* What the page knows: one object, replaced key by key, and the functions that follow it. */

/** A store; `kept` are keys that survive a reload in the tab, under `name`. */
export function makeStore(initial, kept, name) {
  const followers = new Set();
  const now = { ...initial, ...remembered(name) };
  const rounds = [];

  function set(change) {
    const changed = Object.keys(change).filter((key) => !Object.is(now[key], change[key]));
    if (!changed.length) return;
    Object.assign(now, change);
    if (changed.some((key) => kept.includes(key))) remember();
    // What a follower changes is told when all have heard of the change before.
    rounds.push(changed);
    if (rounds.length > 1) return;
    while (rounds.length) {
      tell(rounds[0]);
      rounds.shift();
    }
  }

  function tell(changed) {
    for (const { keys, follow } of [...followers]) {
      if (!keys.some((key) => changed.includes(key))) continue;
      try {
        follow(now);
      } catch (error) {
        // A view with a mistake must not keep the others from what is new.
        reportError(error);
      }
    }
  }

  function remember() {
    const part = Object.fromEntries(kept.map((key) => [key, now[key]]));
    sessionStorage.setItem(name, JSON.stringify(part));
  }

  /** Call `follow(now)` at once and after each change of one of the keys. */
  function follow(keys, follower) {
    followers.add({ keys, follow: follower });
    follower(now);
  }

  return { now, set, follow };
}

function remembered(name) {
  try {
    return JSON.parse(sessionStorage.getItem(name)) ?? {};
  } catch {
    return {};
  }
}
