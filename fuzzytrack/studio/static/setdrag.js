/* A drag of a set or its corner: the shapes that follow from it, drafts of them, and its end. */

import { currentVariable, stepOf } from "./chosenset.js";
import { tidy } from "./numbers.js";
import { isDrawn, mirrored, moved, shapeOf, shifted } from "./shapes.js";

// Pixels within which a corner snaps to another.
const SNAP = 5;

/** Make what drags; `pixel()` gives the width of one in values, `redraw()` shows what is dragged. */
export function makeDrag(app, pixel, redraw) {
  const { store } = app;
  // What is dragged, and what was let go but is not in the state yet.
  let held = null;
  let released = null;

  /** The sets as they are, or as the drag that is going on has them. */
  function sets() {
    const draft = new Map((held ?? released)?.shapes.map((one) => [one.set, one]) ?? []);
    return currentVariable(store.now).sets.map((one) => ({ ...one, ...draft.get(one.name) }));
  }

  /** Send the shapes that a drag or a key has now; `draft` makes no step for undo. */
  function send(shapes, draft) {
    const target = currentVariable(store.now);
    const shared = target.shared_with.length ? store.now.shared : undefined;
    const common = { variable: target.name, shared, ...(draft ? { draft } : {}) };
    return shapes.length === 1
      ? app.edit("set_shape", { ...common, ...shapes[0] })
      : app.edit("set_shapes", { ...common, shapes });
  }

  /** The shapes that follow from one changed set: neighbors with the same corner, the mirror. */
  function followed(one, parameters) {
    const { linked, mirror } = store.now;
    const { universe } = currentVariable(store.now);
    const sets = held?.all ?? currentVariable(store.now).sets;
    if (!isDrawn(one)) return [{ set: one.name, parameters: parameters.map(tidy) }];
    const changed = new Map([[one.name, { set: one.name, shape: one.shape, parameters }]]);
    if (linked && possible()) {
      for (const [from, to] of movedCorners(one, parameters)) {
        for (const other of sets) if (other.name !== one.name) follow(changed, other, from, to);
      }
    }
    if (mirror && possible()) {
      const middle = (universe[0] + universe[1]) / 2;
      for (const { set, shape, parameters: p } of [...changed.values()]) {
        const twin = sets[sets.length - 1 - sets.findIndex(({ name }) => name === set)];
        const image = mirrored({ shape, parameters: p }, middle);
        if (!isDrawn(twin)) continue;
        if (twin.name === set) image.parameters = evened({ shape, parameters: p }, twin.parameters, middle);
        else if (changed.has(twin.name)) continue;
        changed.set(twin.name, { set: twin.name, ...image });
      }
    }
    return [...changed.values()].map((shape) => ({ ...shape, parameters: shape.parameters.map(tidy) }));
  }

  /** As far toward `value` as the neighbors that move along let a corner go. */
  function allowed(set, corner, value) {
    if (!store.now.linked || !possible()) return value;
    const from = corner.place(set.parameters);
    let to = value;
    for (const other of held.all.filter(({ name }) => name !== set.name)) {
      for (const near of cornersAt(other, from)) {
        to = near.place(moved(other, near, to, stepOf(store.now) / 10));
      }
    }
    return to;
  }

  function follow(changed, other, from, to) {
    let { parameters } = changed.get(other.name) ?? other;
    let touched = false;
    for (const corner of cornersAt(other, from)) {
      parameters = moved({ shape: other.shape, parameters }, corner, to, stepOf(store.now) / 10);
      touched = true;
    }
    if (touched) changed.set(other.name, { set: other.name, shape: other.shape, parameters });
  }

  function possible() {
    return app.can("set_shapes");
  }

  function grab(set, corner, x = 0) {
    const all = sets();
    const before = all.find(({ name }) => name === set);
    held = { before, corner, from: x, shapes: [], all };
  }

  /** Move what is held: a corner to `value`, or the whole set. */
  function move(value, free) {
    const { before, corner, from } = held;
    const parameters = corner
      ? moved(before, corner, allowed(before, corner, snapped(value, before.name, free)), stepOf(store.now) / 10)
      : shifted(before, snapStep(value - from, free));
    held.shapes = followed(before, parameters);
    store.set({ dragging: true });
    redraw();
    send(held.shapes, true);
  }

  function snapped(value, own, free) {
    if (free || store.now.snap === "off") return value;
    const places = currentVariable(store.now)
      .sets.filter(({ name }) => name !== own)
      .flatMap((one) => shapeOf(one).corners.map((corner) => corner.place(one.parameters)));
    const reach = SNAP * pixel();
    const near = places.filter((place) => Math.abs(place - value) < reach);
    if (near.length) return near.sort((a, b) => Math.abs(a - value) - Math.abs(b - value))[0];
    const [low] = currentVariable(store.now).universe;
    return low + Math.round((value - low) / stepOf(store.now)) * stepOf(store.now);
  }

  function snapStep(distance, free) {
    return free || store.now.snap === "off" ? distance : Math.round(distance / stepOf(store.now)) * stepOf(store.now);
  }

  /** The end of a drag or of keys: one step for undo. */
  function release() {
    const ended = held;
    held = null;
    store.set({ dragging: false });
    if (!ended?.shapes.length) return;
    released = ended;
    send(ended.shapes, false).then(() => {
      if (released === ended) released = null;
      redraw();
    });
  }

  /** Esc: all sets that the drag has changed are again what they were. */
  function cancel() {
    const { shapes, all } = held;
    const back = all
      .filter(({ name }) => shapes.some(({ set }) => set === name))
      .map(({ name, shape, parameters }) => ({ set: name, shape, parameters }));
    held = null;
    store.set({ dragging: false });
    if (back.length) send(back, false);
    redraw();
  }

  return {
    sets, send, followed, possible, grab, move, release, cancel,
    /** What is dragged, {before, corner}; or null. */
    held: () => held,
    /** Whether what is drawn is newer than the state. */
    isAhead: () => Boolean(held || released),
  };
}

function cornersAt(one, place) {
  return shapeOf(one).corners.filter((corner) => Math.abs(corner.place(one.parameters) - place) < 1e-9);
}

/** A set that is its own mirror: what was changed changes on the other side; the middle stays. */
function evened(one, before, middle) {
  const image = mirrored(one, middle).parameters;
  const both = one.parameters.map((p, k) => (p === before[k] ? image[k] : p));
  const again = mirrored({ ...one, parameters: both }, middle).parameters;
  return both.every((p, k) => Math.abs(p - again[k]) < 1e-9) ? both : before;
}

/** Corners of a set that a change moves: pairs of the place before and after. */
function movedCorners(one, parameters) {
  return shapeOf(one).corners
    .map((corner) => [corner.place(one.parameters), corner.place(parameters)])
    .filter(([from, to]) => from !== to);
}
