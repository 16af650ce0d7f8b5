/* The sets of a variable: curves whose corners are dragged by mouse and keys, and their numbers. */

import { lineColor, shareOf, token } from "./colors.js";
import { check, choice, html, select, svg } from "./elements.js";
import { ask } from "./dialogs.js";
import { keepFocus } from "./focus.js";
import { icon } from "./icons.js";
import { shown, ticks, tidy, typed } from "./numbers.js";
import { pictureMenu, svgFile } from "./pictures.js";
import { textLink } from "./textlink.js";
import { variable, variables } from "./rulebase.js";
import { SHAPES, isDrawn, mirrored, moved, reshaped, shapeOf, shifted } from "./shapes.js";

export const title = "Sets";
const MARGIN = { left: 30, right: 14, top: 34, bottom: 36 };
// Pixels within which a corner or a curve is meant.
const NEAR = 10;
// Pixels within which a corner snaps to another.
const SNAP = 5;

const SHAPES_OF_TEXT =
  "Type the numbers of shapes that are links; to change the shape, follow the link. A linear set has " +
  "no curve: it is the sum of the inputs times its numbers, and of the constant.";
// The handle that moves a set as a whole, as dragging its curve does.
const WHOLE = { name: "whole set", grade: 0.5 };

export function mount(element, app) {
  const { store, say } = app;
  const picture = svg("svg", { class: "sets", role: "group", "aria-label": "Membership functions" });
  const curves = svg("g");
  const handles = svg("g");
  const names = choice("Variable", (name) => store.set({ variable: name, set: null }));
  const options = html("div", { class: "tools" });
  const table = html("table", { class: "numbers-table" });
  const note = html("p", { class: "hint" });
  // What is dragged, and what was let go but is not in the state yet.
  let held = null;
  let released = null;
  let corners = "";

  picture.append(curves, handles);
  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      names.element,
      html("span", { class: "space" }),
      html(
        "button",
        { type: "button", class: "quiet", title: "Add a set", "aria-label": "Add a set", onclick: add },
        icon("add"),
      ),
      pictureMenu("the sets", () => `${store.now.state.name}-${current().name}-sets`, () =>
        svgFile(picture, token("--panel")),
      ),
    ),
    options,
    html("div", { class: "canvas" }, picture),
    html("div", { class: "scroll" }, table),
    note,
  );

  // ------------------------------------------------------------------ what is shown

  function current() {
    const { state, variable: name } = store.now;
    return variable(state?.rulebase, name) ?? variables(state?.rulebase)[0];
  }

  /** The sets as they are, or as the drag that is going on has them. */
  function setsNow() {
    const draft = new Map((held ?? released)?.shapes.map((one) => [one.set, one]) ?? []);
    return current().sets.map((one) => ({ ...one, ...draft.get(one.name) }));
  }

  function chosenSet() {
    return store.now.set ?? current().sets[Math.floor(current().sets.length / 2)].name;
  }

  function scale() {
    const [low, high] = current().universe;
    const { clientWidth: width, clientHeight: height } = picture;
    const [wide, tall] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    return {
      width,
      height,
      low,
      high,
      x: (value) => MARGIN.left + ((value - low) / (high - low)) * wide,
      y: (grade) => MARGIN.top + (1 - grade) * tall,
      value: (pixels) => low + ((pixels - MARGIN.left) / wide) * (high - low),
      pixel: (high - low) / wide,
    };
  }

  /** The step of snapping and of the arrow keys. */
  function step() {
    const [low, high, points] = current().universe;
    if (store.now.snap === "grid") return (high - low) / Math.max(1, points - 1);
    return (high - low) / (store.now.snap === "fine" ? 200 : 1000);
  }

  function draw() {
    const { state, palette } = store.now;
    if (!state?.rulebase) return;
    const at = scale();
    if (at.width <= 0 || at.height <= 0) return;
    const chosen = chosenSet();
    const target = current();
    picture.setAttribute("viewBox", `0 0 ${at.width} ${at.height}`);
    // The chosen set is drawn last, over the others.
    const sets = setsNow().sort((a, b) => (a.name === chosen) - (b.name === chosen));
    curves.replaceChildren(
      ...axis(at, target),
      ...sets.map((one) => curve(at, one, lineColor(palette, shareOf(target, one.name)), one.name === chosen)),
      ...labels(at, setsNow(), chosen, (name) => lineColor(palette, shareOf(target, name))),
      ...explained(at, target, store.now.explanation),
    );
    drawHandles(at, setsNow().find(({ name }) => name === chosen));
  }

  function drawHandles(at, one) {
    const wanted = `${current().name} ${one.name} ${one.shape}`;
    if (wanted !== corners) {
      corners = wanted;
      handles.replaceChildren(...handlesOf(one).map((corner) => handle(one.name, corner)));
    }
    handlesOf(one).forEach((corner, k) => {
      const value = placeOf(one, corner);
      const group = handles.children[k];
      group.setAttribute("transform", `translate(${at.x(clamp(value, at))} ${at.y(corner.grade)})`);
      group.classList.toggle("outside", value < at.low || value > at.high);
      for (const [name, number] of [["now", value], ["min", at.low], ["max", at.high]]) {
        group.setAttribute(`aria-value${name}`, tidy(number));
      }
      group.setAttribute("aria-valuetext", shown(value));
    });
  }

  function handle(set, corner) {
    return svg(
      "g",
      {
        class: "handle",
        role: "slider",
        tabindex: 0,
        "aria-label": `${set}, ${corner.name}`,
        onkeydown: (event) => nudge(event, corner),
        onkeyup: release,
        onblur: release,
      },
      svg("circle", { class: "reach", r: 13 }),
      corner === WHOLE
        ? svg("rect", { class: "knob", x: -4.5, y: -4.5, width: 9, height: 9 })
        : svg("circle", { class: "knob", r: 5.5 }),
    );
  }

  // ------------------------------------------------------------------ changing

  /** Send the shapes that a drag or a key has now; `draft` makes no step for undo. */
  function send(shapes, draft) {
    const target = current();
    const shared = target.shared_with.length ? store.now.shared : undefined;
    const common = { variable: target.name, shared, ...(draft ? { draft } : {}) };
    return shapes.length === 1
      ? app.edit("set_shape", { ...common, ...shapes[0] })
      : app.edit("set_shapes", { ...common, shapes });
  }

  /** The shapes that follow from one changed set: neighbors with the same corner, the mirror. */
  function followed(one, parameters) {
    const { linked, mirror } = store.now;
    const { universe } = current();
    const sets = held?.all ?? current().sets;
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
        to = near.place(moved(other, near, to, step() / 10));
      }
    }
    return to;
  }

  function follow(changed, other, from, to) {
    let { parameters } = changed.get(other.name) ?? other;
    let touched = false;
    for (const corner of cornersAt(other, from)) {
      parameters = moved({ shape: other.shape, parameters }, corner, to, step() / 10);
      touched = true;
    }
    if (touched) changed.set(other.name, { set: other.name, shape: other.shape, parameters });
  }

  function possible() {
    return app.can("set_shapes");
  }

  function grab(set, corner, x = 0) {
    const all = setsNow();
    const before = all.find(({ name }) => name === set);
    held = { before, corner, from: x, shapes: [], all };
  }

  /** Move what is held: a corner to `value`, or the whole set. */
  function move(value, free) {
    const { before, corner, from } = held;
    const parameters = corner
      ? moved(before, corner, allowed(before, corner, snapped(value, before.name, free)), step() / 10)
      : shifted(before, snapStep(value - from, free));
    held.shapes = followed(before, parameters);
    store.set({ dragging: true });
    draw();
    showNumbers();
    send(held.shapes, true);
  }

  function snapped(value, own, free) {
    if (free || store.now.snap === "off") return value;
    const places = current()
      .sets.filter(({ name }) => name !== own)
      .flatMap((one) => shapeOf(one).corners.map((corner) => corner.place(one.parameters)));
    const reach = SNAP * scale().pixel;
    const near = places.filter((place) => Math.abs(place - value) < reach);
    if (near.length) return near.sort((a, b) => Math.abs(a - value) - Math.abs(b - value))[0];
    const [low] = current().universe;
    return low + Math.round((value - low) / step()) * step();
  }

  function snapStep(distance, free) {
    return free || store.now.snap === "off" ? distance : Math.round(distance / step()) * step();
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
      draw();
      showNumbers();
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
    draw();
    showNumbers();
  }

  function nudge(event, corner) {
    const direction = {
      ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10,
    }[event.key];
    if (event.key === "Escape" && held) cancel();
    if (!direction || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const set = chosenSet();
    const now = () => setsNow().find(({ name }) => name === set);
    if (!held) grab(set, corner === WHOLE ? null : corner, placeOf(now(), corner));
    const far = direction * (event.shiftKey ? 10 : 1) * step();
    move(placeOf(now(), corner) + far, true);
  }

  // ------------------------------------------------------------------ the mouse

  /** What lies under the pointer: a corner, else a curve. */
  function under(event) {
    const at = scale();
    const box = picture.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const chosen = chosenSet();
    const touch = event.pointerType === "mouse" ? 1 : 1.8;
    let best = null;
    for (const one of current().sets) {
      for (const corner of shapeOf(one).corners) {
        const place = clamp(corner.place(one.parameters), at);
        const far = Math.hypot(at.x(place) - x, at.y(corner.grade) - y) - (one.name === chosen ? 4 : 0);
        if (far < NEAR * touch && far < (best?.far ?? Infinity)) best = { set: one.name, corner, far };
      }
    }
    if (best) return best;
    const value = at.value(x);
    const byCurve = current().sets
      .map((one) => ({ set: one.name, far: Math.abs(at.y(shapeOf(one).grade(value, one.parameters)) - y) }))
      .filter(({ far }) => far < NEAR * touch && y < at.y(0.02))
      .sort((a, b) => a.far - b.far);
    const inside = current().sets.find(({ name }) => name === chosen);
    const grade = shapeOf(inside).grade(value, inside.parameters);
    if (y > at.y(grade) && y < at.y(0.02)) return { set: chosen, value };
    return byCurve.length ? { ...byCurve[0], value } : null;
  }

  picture.addEventListener("pointerdown", (event) => {
    const found = event.button === 0 && under(event);
    if (!found) return;
    event.preventDefault();
    picture.setPointerCapture(event.pointerId);
    const again = found.set === chosenSet();
    store.set({ set: found.set });
    // A first press on a curve chooses it; only the chosen set is dragged as a whole.
    const whole = again && isDrawn(current().sets.find(({ name }) => name === found.set));
    if (found.corner || whole) grab(found.set, found.corner, found.value);
    if (held) handles.children[handlesOf(held.before).indexOf(found.corner ?? WHOLE)]?.focus();
  });
  picture.addEventListener("pointermove", (event) => {
    if (held && event.buttons) {
      const box = picture.getBoundingClientRect();
      move(scale().value(event.clientX - box.left), event.altKey);
    } else picture.classList.toggle("near", Boolean(under(event)?.corner));
  });
  picture.addEventListener("pointerup", release);
  picture.addEventListener("pointercancel", release);
  picture.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && held) cancel();
  });

  // ------------------------------------------------------------------ numbers

  function showNumbers() {
    const sets = setsNow();
    const structure = JSON.stringify([
      current().name, store.now.palette, store.now.scheme, sets.map(({ name, shape }) => [name, shape]),
    ]);
    if (table.dataset.structure !== structure) {
      table.dataset.structure = structure;
      keepFocus(table, () => fillTable(sets));
    }
    showHeads(sets);
    note.textContent = sets.every(isDrawn) ? "" : SHAPES_OF_TEXT;
    sets.forEach((one, k) => {
      const row = table.tBodies[0].rows[k];
      row.classList.toggle("chosen", one.name === chosenSet());
      row.querySelectorAll("input.number").forEach((box, i) => {
        if (document.activeElement !== box || held) box.value = rounded(one.parameters[i]);
      });
    });
  }

  /** The parameters of the chosen set stand over the columns. */
  function showHeads(sets) {
    const own = shapeOf(sets.find(({ name }) => name === chosenSet())).parameters;
    longest(sets).forEach((name, k) => {
      table.tHead.rows[0].cells[2 + k].textContent = own[k] ?? name;
    });
  }

  function fillTable(sets) {
    const most = longest(sets).length;
    const heads = ["set", "shape", ...longest(sets)].map((text) => html("th", { scope: "col" }, text));
    const last = html("th", { scope: "col" }, html("span", { class: "unseen" }, "remove"));
    table.replaceChildren(
      html("thead", {}, html("tr", {}, heads, last)),
      html("tbody", {}, sets.map((one) => numberRow(one, most))),
    );
  }

  function numberRow(one, most) {
    const { palette } = store.now;
    const swatch = html("button", {
      type: "button",
      class: "swatch",
      title: `Choose ${one.name}`,
      "aria-label": `Choose ${one.name}`,
      onclick: () => store.set({ set: one.name }),
    });
    swatch.style.setProperty("--paint", lineColor(palette, shareOf(current(), one.name)));
    const fields = shapeOf(one).parameters.map((name, k) => html("td", {}, numberBox(one, name, k)));
    const rest = Array.from({ length: most - fields.length }, () => html("td"));
    return html(
      "tr",
      { onfocusin: () => store.set({ set: one.name }) },
      html("th", { scope: "row" }, swatch, nameBox(one)),
      html("td", {}, shapeBox(one)),
      ...fields,
      ...rest,
      html(
        "td",
        {},
        html(
          "button",
          {
            type: "button",
            class: "quiet",
            title: `Remove ${one.name}`,
            "aria-label": `Remove ${one.name}`,
            onclick: () => remove(one.name),
          },
          icon("remove"),
        ),
      ),
    );
  }

  function numberBox(one, name, k) {
    const box = html("input", {
      type: "text",
      inputmode: "decimal",
      class: "number",
      title: name,
      "aria-label": `${one.name}, ${name}`,
      onchange: () => change(typed(box.value)),
      onkeydown: (event) => {
        const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
        if (!direction) return;
        event.preventDefault();
        const value = tidy(typed(box.value) + direction * (event.shiftKey ? 10 : 1) * step());
        box.value = String(value);
        change(value);
      },
    });

    function change(value) {
      const now = current().sets.find((set) => set.name === one.name);
      if (!Number.isFinite(value)) {
        say(`${one.name}, ${name}: type a number.`, "error");
        box.value = rounded(now.parameters[k]);
        return;
      }
      send(followed(now, now.parameters.with(k, value)), false).then((done) => {
        if (!done) box.value = rounded(now.parameters[k]);
      });
    }

    return box;
  }

  function nameBox(one) {
    const box = html("input", {
      type: "text",
      class: "set-name",
      spellcheck: "false",
      size: Math.max(3, one.name.length),
      "aria-label": `Name of the set ${one.name}`,
      onchange: async () => {
        const name = box.value.trim();
        const done = await app.edit("rename_set", { variable: current().name, set: one.name, name });
        if (done) store.set({ set: name });
        else box.value = one.name;
      },
    });
    box.value = one.name;
    return box;
  }

  function shapeBox(one) {
    // A shape that the page does not draw stays what it is; its numbers may be typed.
    if (!isDrawn(one)) return textLink(app, one.shape, one.line, true);
    const shapes = Object.entries(SHAPES).map(([key, { title: text }]) => [key, text]);
    return select(`Shape of ${one.name}`, shapes, one.shape, (shape) => {
      const now = current().sets.find(({ name }) => name === one.name);
      const parameters = reshaped(now, shape, step() / 10).map(tidy);
      send([{ set: one.name, shape, parameters }], false);
    });
  }

  function remove(set) {
    const args = { variable: current().name, set, shared: store.now.shared };
    app.edit("remove_set", args, ({ message }) =>
      ask(`Remove ${set} from ${args.variable}?`, [html("p", {}, message)], [
        ["Remove it with its rules", () => app.edit("remove_set", { ...args, with_rules: true })],
      ]),
    );
  }

  function add() {
    const { name, sets, universe } = current();
    const [low, high] = universe;
    let k = sets.length + 1;
    while (sets.some((one) => one.name === `set${k}`)) k += 1;
    const [middle, reach] = [(low + high) / 2, (high - low) / 8];
    const parameters = [middle - reach, middle, middle + reach].map(tidy);
    app
      .edit("add_set", { variable: name, set: `set${k}`, shape: "trimf", parameters })
      .then((done) => done && store.set({ set: `set${k}` }));
  }

  function showOptions() {
    const { snap, linked, mirror, shared } = store.now;
    const target = current();
    const [low, high, points] = target.universe;
    const grid = shown((high - low) / Math.max(1, points - 1), 3);
    const others = target.shared_with.join(" and ");
    // A drag changes the state many times a second, and the options hardly ever.
    const known = JSON.stringify([target.name, others, grid, snap, linked, mirror, shared, possible()]);
    if (options.dataset.known === known) return;
    options.dataset.known = known;
    const controls = [
      select(
        "Snap",
        [["grid", `snap ${grid}`], ["fine", `snap ${shown((high - low) / 200, 3)}`], ["off", "no snap"]],
        snap,
        (value) => store.set({ snap: value }),
      ),
      ...(possible()
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
    keepFocus(options, () => options.replaceChildren(...controls));
  }

  store.follow(["state", "variable"], ({ state, variable: name }) => {
    const { rulebase } = state ?? {};
    if (!rulebase) return;
    const target = current();
    names.show(variables(rulebase).map((one) => [one.name, one.name, one.label]), target.name);
    if (target.name !== name) store.set({ variable: target.name });
    if (store.now.set && !target.sets.some((one) => one.name === store.now.set)) store.set({ set: null });
  });
  store.follow(["state", "variable", "snap", "linked", "mirror", "shared", "hello"], ({ state }) => {
    if (state?.rulebase && !held) showOptions();
  });
  store.follow(["state", "variable", "set", "palette", "scheme", "explanation", "view"], ({ state }) => {
    // What is dragged has been drawn already.
    if (!state?.rulebase || held || released) return;
    draw();
    showNumbers();
  });
  new ResizeObserver(draw).observe(picture);
}

// ---------------------------------------------------------------------- drawing

/** Names of the parameters of a set that has most of them. */
function longest(sets) {
  const all = sets.map((one) => shapeOf(one).parameters);
  return all.reduce((best, one) => (one.length > best.length ? one : best));
}

/** A parameter as it fits its field; what is not typed anew keeps all its digits. */
function rounded(parameter) {
  return String(Number(parameter.toPrecision(4)));
}

function clamp(value, { low, high }) {
  return Math.max(low, Math.min(high, value));
}

/** What a set is moved by: its corners, and itself as a whole. */
function handlesOf(one) {
  const { corners } = shapeOf(one);
  return corners.length > 1 ? [...corners, WHOLE] : corners;
}

function placeOf(one, corner) {
  if (corner !== WHOLE) return corner.place(one.parameters);
  const [, b, c] = shapeOf(one).quad(one.parameters);
  return (b + c) / 2;
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

function axis(at, { name, label }) {
  const bottom = at.y(0);
  const words = label === name ? name : `${name}: ${label}`;
  const parts = [0, 0.5, 1].flatMap((grade) => [
    svg("line", { class: "grid", x1: at.x(at.low), x2: at.x(at.high), y1: at.y(grade), y2: at.y(grade) }),
    svg("text", { class: "number", x: MARGIN.left - 6, y: at.y(grade) + 4, "text-anchor": "end" }, shown(grade)),
  ]);
  for (const value of ticks(at.low, at.high, at.width / 60)) {
    const x = at.x(value);
    parts.push(svg("line", { class: "tick", x1: x, x2: x, y1: bottom, y2: bottom + 4 }));
    parts.push(svg("text", { class: "number", x, y: bottom + 15, "text-anchor": "middle" }, shown(value)));
  }
  const middle = (at.x(at.low) + at.x(at.high)) / 2;
  parts.push(svg("text", { class: "axis", x: middle, y: at.height - 4, "text-anchor": "middle" }, words));
  return parts;
}

function curve(at, one, stroke, chosen) {
  const { grade, corners } = shapeOf(one);
  const even = Array.from({ length: 161 }, (_, k) => at.low + ((at.high - at.low) * k) / 160);
  const exact = corners.map((corner) => corner.place(one.parameters)).filter((x) => x >= at.low && x <= at.high);
  // Beside a corner too, where a vertical flank jumps.
  const beside = exact.flatMap((x) => [x - 1e-9 * (at.high - at.low), x, x + 1e-9 * (at.high - at.low)]);
  const places = [...even, ...beside].filter((x) => x >= at.low && x <= at.high).sort((a, b) => a - b);
  if (Number.isNaN(grade(at.low, one.parameters))) return svg("g");
  const points = places.map((x) => `${at.x(x).toFixed(1)},${at.y(grade(x, one.parameters)).toFixed(1)}`);
  const line = svg("polyline", { class: chosen ? "curve chosen" : "curve", points: points.join(" "), stroke });
  if (!chosen) return line;
  const foot = `${at.x(at.low)},${at.y(0)} ${points.join(" ")} ${at.x(at.high)},${at.y(0)}`;
  return svg("g", {}, svg("polygon", { class: "inside", points: foot, fill: stroke }), line);
}

/** Names over the peaks, in two rows where they would touch. */
function labels(at, sets, chosen, paint) {
  const ends = [-Infinity, -Infinity];
  const places = sets.map((one) => {
    const [, b, c] = shapeOf(one).quad(one.parameters);
    return { name: one.name, x: (at.x(clamp(b, at)) + at.x(clamp(c, at))) / 2 };
  });
  return places
    .filter(({ x }) => Number.isFinite(x))
    .sort((a, b) => a.x - b.x)
    .map(({ name, x }) => {
      const half = 4 * name.length + 3;
      const row = x - half > ends[0] ? 0 : 1;
      ends[row] = x + half;
      const middle = Math.max(half, Math.min(at.width - half, x));
      return svg(
        "text",
        {
          class: name === chosen ? "name chosen" : "name",
          x: middle,
          y: MARGIN.top - 7 - 13 * row,
          "text-anchor": "middle",
          fill: paint(name),
        },
        name,
      );
    });
}

/** The explained value of the variable, as a line through its sets. */
function explained(at, { name }, explanation) {
  const value = explanation?.inputs[name] ?? explanation?.outputs[name];
  if (!Number.isFinite(value)) return [];
  const x = at.x(clamp(value, at));
  return [svg("line", { class: "explained", x1: x, x2: x, y1: at.y(1.04), y2: at.y(0) })];
}
