/* The pane of sets: the curves of a variable, dragged by mouse and keys, with their numbers below. */

import { chosenSet, currentVariable, stepOf } from "./chosenset.js";
import { lineColor, shareOf, token } from "./colors.js";
import { choice, html, svg } from "./elements.js";
import { icon } from "./icons.js";
import { pictureMenu, svgFile } from "./pictures.js";
import { variables } from "./rulebase.js";
import { axis, clamp, curve, explained, labels, scaleOf } from "./setcurves.js";
import { makeDrag } from "./setdrag.js";
import { WHOLE, handlesOf, makeHandle, placeOf, putHandle } from "./sethandles.js";
import { setOptions } from "./setoptions.js";
import { addSet, makeSetTable } from "./settable.js";
import { isDrawn, shapeOf } from "./shapes.js";

export const title = "Sets";
// Pixels within which a corner or a curve is meant.
const NEAR = 10;

export function mount(element, app) {
  const { store } = app;
  const picture = svg("svg", { class: "sets", role: "group", "aria-label": "Membership functions" });
  const curves = svg("g");
  const handles = svg("g");
  const names = choice("Variable", (name) => store.set({ variable: name, set: null }));
  const options = setOptions(app);
  const scale = () => scaleOf(picture, current());
  const drag = makeDrag(app, () => scale().pixel, redraw);
  const table = makeSetTable(app, drag);
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
        { type: "button", class: "quiet", title: "Add a set", "aria-label": "Add a set", onclick: () => addSet(app) },
        icon("add"),
      ),
      pictureMenu("the sets", () => `${store.now.state.name}-${current().name}-sets`, () =>
        svgFile(picture, token("--panel")),
      ),
    ),
    options.element,
    html("div", { class: "canvas" }, picture),
    html("div", { class: "scroll" }, table.element),
    table.note,
  );

  function current() {
    return currentVariable(store.now);
  }

  function redraw() {
    draw();
    table.show();
  }

  function draw() {
    const { state, palette } = store.now;
    if (!state?.rulebase) return;
    const at = scale();
    if (at.width <= 0 || at.height <= 0) return;
    const chosen = chosenSet(store.now);
    const target = current();
    picture.setAttribute("viewBox", `0 0 ${at.width} ${at.height}`);
    // The chosen set is drawn last, over the others.
    const sets = drag.sets().sort((a, b) => (a.name === chosen) - (b.name === chosen));
    curves.replaceChildren(
      ...axis(at, target),
      ...sets.map((one) => curve(at, one, lineColor(palette, shareOf(target, one.name)), one.name === chosen)),
      ...labels(at, drag.sets(), chosen, (name) => lineColor(palette, shareOf(target, name))),
      ...explained(at, target, store.now.explanation),
    );
    drawHandles(at, drag.sets().find(({ name }) => name === chosen));
  }

  function drawHandles(at, one) {
    const wanted = `${current().name} ${one.name} ${one.shape}`;
    if (wanted !== corners) {
      corners = wanted;
      handles.replaceChildren(...handlesOf(one).map((corner) => handle(one.name, corner)));
    }
    handlesOf(one).forEach((corner, k) => {
      putHandle(handles.children[k], at, one, corner);
    });
  }

  function handle(set, corner) {
    const release = () => drag.release();
    return makeHandle(set, corner, { onkeydown: (event) => nudge(event, corner), onkeyup: release, onblur: release });
  }

  function nudge(event, corner) {
    const direction = {
      ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10,
    }[event.key];
    if (event.key === "Escape" && drag.held()) drag.cancel();
    if (!direction || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    const set = chosenSet(store.now);
    const now = () => drag.sets().find(({ name }) => name === set);
    if (!drag.held()) drag.grab(set, corner === WHOLE ? null : corner, placeOf(now(), corner));
    const far = direction * (event.shiftKey ? 10 : 1) * stepOf(store.now);
    drag.move(placeOf(now(), corner) + far, true);
  }

  // ------------------------------------------------------------------ the mouse

  /** What lies under the pointer: a corner, else a curve. */
  function under(event) {
    const at = scale();
    const box = picture.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const chosen = chosenSet(store.now);
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
    const again = found.set === chosenSet(store.now);
    store.set({ set: found.set });
    // A first press on a curve chooses it; only the chosen set is dragged as a whole.
    const whole = again && isDrawn(current().sets.find(({ name }) => name === found.set));
    if (found.corner || whole) drag.grab(found.set, found.corner, found.value);
    const held = drag.held();
    if (held) handles.children[handlesOf(held.before).indexOf(found.corner ?? WHOLE)]?.focus();
  });
  picture.addEventListener("pointermove", (event) => {
    if (drag.held() && event.buttons) {
      const box = picture.getBoundingClientRect();
      drag.move(scale().value(event.clientX - box.left), event.altKey);
    } else picture.classList.toggle("near", Boolean(under(event)?.corner));
  });
  picture.addEventListener("pointerup", drag.release);
  picture.addEventListener("pointercancel", drag.release);
  picture.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && drag.held()) drag.cancel();
  });

  store.follow(["state", "variable"], ({ state, variable: name }) => {
    const { rulebase } = state ?? {};
    if (!rulebase) return;
    const target = current();
    names.show(variables(rulebase).map((one) => [one.name, one.name, one.label]), target.name);
    if (target.name !== name) store.set({ variable: target.name });
    if (store.now.set && !target.sets.some((one) => one.name === store.now.set)) store.set({ set: null });
  });
  store.follow(["state", "variable", "snap", "linked", "mirror", "shared", "hello"], ({ state }) => {
    if (state?.rulebase && !drag.held()) options.show();
  });
  store.follow(["state", "variable", "set", "palette", "scheme", "explanation", "view"], ({ state }) => {
    // What is dragged has been drawn already.
    if (!state?.rulebase || drag.isAhead()) return;
    redraw();
  });
  new ResizeObserver(draw).observe(picture);
}
