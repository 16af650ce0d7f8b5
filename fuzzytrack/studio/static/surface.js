/* The surface in three dimensions: turned by mouse and keys, clicked for an explanation. */

import { check, choice, html, select } from "./elements.js";
import { keepFocus } from "./focus.js";
import { icon } from "./icons.js";
import { shown, span } from "./numbers.js";
import { pictureMenu } from "./pictures.js";
import { axesOf, drawable, signOf } from "./rulebase.js";
import { makeStage } from "./stage.js";
import { drawCurve, onCurve } from "./surfacecurve.js";
import { SurfacePainter } from "./surfacepainter.js";

export const title = "Surface";
const HOME = { azimuth: -125, elevation: 30, zoom: 1 };
const POINTS = [41, 61, 121, 201];

export function mount(element, app) {
  const { store } = app;
  const canvas = html("canvas", {
    tabindex: 0,
    role: "application",
    "aria-roledescription": "surface in three dimensions",
    "aria-describedby": "surface-keys",
  });
  const note = html("p", { class: "note", hidden: true });
  const outputs = choice("Output that is shown", (shown) => store.set({ shown }));
  const against = html("span");
  const over = html("span", { class: "over" });
  const stage = makeStage(canvas, draw, () => app.drawn(store.now.values?.version ?? -1));

  element.append(
    html(
      "header",
      {},
      html("h2", {}, title),
      outputs.element,
      html("span", { class: "space" }),
      html(
        "button",
        { type: "button", class: "quiet", title: "Turn back (0)", "aria-label": "Turn back", onclick: home },
        icon("home"),
      ),
      pictureMenu("the surface", () => `${store.now.state.name}-${store.now.shown}`, stage.file),
    ),
    html(
      "div",
      { class: "tools" },
      against,
      over,
      html("span", { class: "visits-check" }),
      html("span", { class: "space" }),
      select(
        "Points on each axis",
        POINTS.map((n) => [n, `${n} × ${n}`]),
        store.now.points,
        (points) => store.set({ points: Number(points) }),
      ),
    ),
    html("div", { class: "canvas" }, canvas, note),
    html(
      "p",
      { id: "surface-keys", class: "unseen" },
      "Arrow keys turn, plus and minus zoom, 0 turns back. Shift and arrow keys move the explained point.",
    ),
  );

  function draw(pen, width, height) {
    const { values } = store.now;
    if (!values) return;
    if (values.rows === 1) drawCurve(pen, width, height, values, store.now.point);
    else new SurfacePainter(store.now, width, height).draw(pen);
  }

  function home() {
    store.set({ camera: HOME });
  }

  function turn(azimuth, elevation) {
    const { camera } = store.now;
    store.set({
      camera: {
        ...camera,
        azimuth: (camera.azimuth + azimuth) % 360,
        elevation: Math.max(4, Math.min(90, camera.elevation + elevation)),
      },
    });
  }

  function zoom(factor) {
    const { camera } = store.now;
    store.set({ camera: { ...camera, zoom: Math.max(0.5, Math.min(4, camera.zoom * factor)) } });
  }

  function explain(event) {
    const { values, state } = store.now;
    if (!values) return;
    const place = [event.offsetX, event.offsetY];
    const size = [canvas.clientWidth, canvas.clientHeight];
    const at =
      values.rows === 1 ? onCurve(place, size, values) : new SurfacePainter(store.now, ...size).pick(...place);
    if (at) app.explain(Object.fromEntries(values.axes.map(({ name }, k) => [name, at[k]])), state);
  }

  let grip = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    canvas.setPointerCapture(event.pointerId);
    grip = { x: event.clientX, y: event.clientY, turned: false };
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!grip) return;
    const [right, down] = [event.clientX - grip.x, event.clientY - grip.y];
    if (!grip.turned && Math.hypot(right, down) < 4) return;
    turn(-0.5 * right, 0.4 * down);
    grip = { x: event.clientX, y: event.clientY, turned: true };
  });
  canvas.addEventListener("pointerup", (event) => {
    if (grip && !grip.turned) explain(event);
    grip = null;
  });
  canvas.addEventListener("pointercancel", () => (grip = null));
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      zoom(event.deltaY < 0 ? 1.08 : 1 / 1.08);
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[
      event.key
    ];
    if (step && event.shiftKey) app.stepPoint(...step);
    else if (step) turn(-5 * step[0], 5 * step[1]);
    else if (event.key === "+" || event.key === "=") zoom(1.1);
    else if (event.key === "-") zoom(1 / 1.1);
    else if (event.key === "0" || event.key === "Home") home();
    else if (event.key === "Enter") app.stepPoint(0, 0);
    else return;
    event.preventDefault();
  });

  store.follow(["state", "shown"], ({ state, shown }) => {
    const { rulebase } = state ?? {};
    const labels = Object.fromEntries(rulebase?.outputs.map((one) => [one.name, one.label]) ?? []);
    outputs.show(
      drawable(rulebase).map((name) => [name, signOf(name), labels[name]]),
      shown,
    );
  });
  store.follow(["state", "axes"], ({ state, axes }) => {
    const inputs = state?.rulebase?.inputs ?? [];
    over.hidden = inputs.length < 3;
    if (over.hidden) return;
    const chosen = axesOf(state.rulebase, axes).map(({ name }) => name);
    const selects = chosen.map((name, k) =>
      select(
        k ? "Input that runs to the back" : "Input that runs to the right",
        inputs.map((one) => [one.name, `${k ? "y" : "x"}: ${one.name}`]),
        name,
        // The same input twice would be no surface: the two change places.
        (now) => store.set({ axes: now === chosen[1 - k] ? [...chosen].reverse() : chosen.with(k, now) }),
      ),
    );
    keepFocus(over, () => over.replaceChildren(...selects));
  });
  store.follow(["files", "shipped", "against"], ({ files, shipped, against: chosen }) => {
    const names = [...files.filter(({ kind }) => kind === "rules").map(({ name }) => name), ...shipped];
    const options = [["", "no difference"], ["saved", "minus what was saved"]];
    const difference = select(
      "Difference to another rule base",
      [...options, ...names.map((name) => [name, `minus ${name}`])],
      chosen ?? "",
      (name) => store.set({ against: name || null }),
    );
    keepFocus(against, () => against.replaceChildren(difference));
  });
  store.follow(["visits", "shadeVisits"], ({ visits, shadeVisits }) => {
    const place = element.querySelector(".visits-check");
    const shade = visits
      ? [
          check("visits", shadeVisits, (on) => store.set({ shadeVisits: on }),
            "Colors where the last run was; gray where it never came"),
        ]
      : [];
    keepFocus(place, () => place.replaceChildren(...shade));
  });
  store.follow(["values", "valuesError"], ({ values, valuesError }) => {
    const empty = values?.heights.some(Number.isNaN);
    note.hidden = !(valuesError || empty);
    note.textContent = valuesError ?? "In the holes no rule fires.";
    const [low, high] = values ? span(values.heights) : [NaN, NaN];
    const over = values?.axes.map(({ name }) => name).join(" and ");
    canvas.setAttribute(
      "aria-label",
      values
        ? `${values.output} over ${over}, from ${shown(low)} to ${shown(high)}`
        : "No surface: the rule base has complaints",
    );
  });
  store.follow(
    ["values", "camera", "point", "palette", "scheme", "visits", "shadeVisits", "view"],
    stage.redraw,
  );
}
