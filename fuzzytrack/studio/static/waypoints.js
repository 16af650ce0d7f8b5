/* Way-points: handles on the map that are dragged or moved by keys, and a list of typed numbers. */

import { html, svg } from "./elements.js";
import { enable, isEnabled, keepFocus } from "./focus.js";
import { icon } from "./icons.js";
import { distance } from "./map.js";
import { shown, tidy, typed } from "./numbers.js";

const RADIUS = 6;
// Steps of the arrow keys in pixels, rounded to a round number of meters.
const STEP = 8;

/**
 * The layer of the map. `read()` gives {points, between}: the way-points, and a place in the middle
 * of each leg; `write(points)` changes them, `draft(points)` shows them while they are dragged;
 * `named(k)` is what number k from 1 is called.
 */
export function waypointLayer({ map, read, write, draft = () => {}, named = (k) => `Way-point ${k}` }) {
  const route = svg("polyline", { class: "route" });
  const middles = svg("g", {});
  const handles = svg("g", {});
  const element = svg("g", {}, route, middles, handles);
  let dragged = null;

  function points() {
    return dragged ?? read().points;
  }

  function draw(place) {
    const all = points();
    element.classList.toggle("dragging", dragged !== null);
    const pairs = all.map(([x, y]) => `${place.x(x)},${place.y(y)}`).join(" ");
    route.setAttribute("points", pairs);
    fit(handles, all.length, () => handleOf("waypoint"));
    all.forEach(([x, y], k) => {
      const handle = handles.children[k];
      put(handle, place, x, y);
      handle.setAttribute("aria-label", `${named(k + 1)}: x ${shown(x, 6)} m, y ${shown(y, 6)} m`);
      handle.lastChild.textContent = named(k + 1).replace("Way-point ", "");
    });
    const between = dragged ? [] : read().between;
    fit(middles, between.length, () => handleOf("between"));
    between.forEach(([x, y], k) => {
      put(middles.children[k], place, x, y);
      middles.children[k].setAttribute("aria-label", `Insert a way-point after ${k + 1}`);
    });
  }

  function handleOf(kind) {
    const handle = svg(
      "g",
      { class: kind, tabindex: 0, role: "button", "data-handle": kind },
      svg("circle", { class: "reach", r: 14 }),
      svg("circle", { class: "knob", r: kind === "between" ? 4 : RADIUS }),
      svg("text", { x: 10, y: -9 }),
    );
    handle.addEventListener("pointerdown", press);
    handle.addEventListener("keydown", kind === "between" ? insertByKey : keys);
    return handle;
  }

  function indexOf(handle) {
    return [...handle.parentNode.children].indexOf(handle);
  }

  function press(event) {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    const handle = event.currentTarget;
    const at = indexOf(handle);
    const fresh = handle.classList.contains("between");
    const before = read().points.map((point) => [...point]);
    const all = before.map((point) => [...point]);
    if (fresh) all.splice(at + 1, 0, [...read().between[at]]);
    const index = fresh ? at + 1 : at;
    let moved = fresh;
    handle.focus();

    function move(next) {
      const { x, y } = map.toWorld(next);
      if (!moved && Math.hypot(next.clientX - event.clientX, next.clientY - event.clientY) < 3) return;
      moved = true;
      all[index] = [rounded(x), rounded(y)];
      dragged = all;
      draft(all);
      map.redraw();
    }

    function end(last) {
      removeEventListener("pointermove", move);
      removeEventListener("pointerup", end);
      removeEventListener("keydown", escape, true);
      if (!moved) return;
      // The points stay where they were put until the server has drawn the curve through them.
      if (last.type === "pointerup") finish(all, index);
      else finish(before, at);
    }

    function escape(key) {
      if (key.key !== "Escape") return;
      key.stopPropagation();
      end(key);
    }

    addEventListener("pointermove", move);
    addEventListener("pointerup", end);
    addEventListener("keydown", escape, true);
  }

  async function finish(all, focus) {
    const hold = () => requestAnimationFrame(() => handles.children[Math.min(focus, all.length - 1)]?.focus());
    dragged = all;
    map.redraw();
    hold();
    await write(all);
    dragged = null;
    map.redraw();
    hold();
  }

  function keys(event) {
    const at = indexOf(event.currentTarget);
    const all = read().points.map((point) => [...point]);
    const step = (event.shiftKey ? 10 : 1) * round(STEP * map.place.scale);
    const way = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 1], ArrowDown: [1, -1] }[event.key];
    if (way) {
      const [axis, sign] = way;
      all[at][axis] = tidy(Math.round(all[at][axis] / step + sign) * step);
      finish(all, at);
    } else if (event.key === "Delete" || event.key === "Backspace") {
      if (all.length <= 2) return;
      all.splice(at, 1);
      finish(all, at);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  function insertByKey(event) {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    const at = indexOf(event.currentTarget);
    const all = read().points.map((point) => [...point]);
    all.splice(at + 1, 0, read().between[at].map(rounded));
    finish(all, at + 1);
  }

  function rounded(value) {
    const step = round(map.place.scale);
    return tidy(Math.round(value / step) * step);
  }

  return { element, draw };
}

/** The list of way-points with typed numbers; `write(points)` changes them. */
export function waypointList(write) {
  const rows = html("tbody", {});
  const element = html(
    "table",
    { class: "waypoints" },
    html("caption", { class: "unseen" }, "Way-points"),
    html(
      "thead",
      {},
      html(
        "tr",
        {},
        ["", "x (m)", "y (m)", "leg", ""].map((text) => html("th", { scope: "col" }, text)),
      ),
    ),
    rows,
  );
  let now = [];

  function show(points) {
    now = points;
    keepFocus(rows, () => fit(rows, points.length, rowOf));
    points.forEach((point, k) => {
      const row = rows.children[k];
      row.firstChild.textContent = String(k + 1);
      point.forEach((value, axis) => {
        const input = row.children[1 + axis].firstChild;
        if (document.activeElement !== input) input.value = shown(value, 8);
        input.setAttribute("aria-label", `Way-point ${k + 1}, ${"xy"[axis]} in meters`);
        input.removeAttribute("aria-invalid");
      });
      row.children[3].textContent = k ? distance(apart(points[k - 1], point)) : "";
      const [insert, remove] = row.children[4].children;
      insert.setAttribute("aria-label", `Insert a way-point after ${k + 1}`);
      remove.setAttribute("aria-label", `Delete way-point ${k + 1}`);
      enable(remove, points.length > 2);
    });
  }

  function rowOf() {
    const row = html("tr", {}, html("th", { scope: "row" }));
    const index = () => [...rows.children].indexOf(row);
    for (const axis of [0, 1]) {
      const input = html("input", { type: "text", inputmode: "decimal", autocomplete: "off" });
      const take = () => {
        const value = typed(input.value);
        input.setAttribute("aria-invalid", String(!Number.isFinite(value)));
        if (!Number.isFinite(value) || input.value === shown(now[index()][axis], 8)) return;
        const points = now.map((point) => [...point]);
        points[index()][axis] = value;
        write(points);
      };
      input.addEventListener("change", take);
      row.append(html("td", {}, input));
    }
    const insert = () => {
      const points = now.map((point) => [...point]);
      const k = index();
      const next = points[k + 1] ?? points[k].map((value, axis) => 2 * value - points[k - 1][axis]);
      const share = points[k + 1] ? 0.5 : 1;
      points.splice(
        k + 1,
        0,
        points[k].map((value, axis) => tidy(value + share * (next[axis] - value))),
      );
      write(points);
    };
    const remove = ({ currentTarget }) => isEnabled(currentTarget) && write(now.filter((_, k) => k !== index()));
    row.append(
      html("td", { class: "number" }),
      html(
        "td",
        { class: "row-tools" },
        html(
          "button",
          { type: "button", class: "quiet", title: "Insert after", onclick: insert },
          icon("add"),
        ),
        html("button", { type: "button", class: "quiet", title: "Delete", onclick: remove }, icon("remove")),
      ),
    );
    return row;
  }

  return { element, show };
}

function put(handle, place, x, y) {
  handle.setAttribute("transform", `translate(${place.x(x)} ${place.y(y)})`);
}

function fit(parent, count, make) {
  while (parent.children.length > count) parent.lastChild.remove();
  while (parent.children.length < count) parent.append(make());
}

/** The round number (1, 2 or 5 times a power of ten) next to a number, from above. */
function round(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((m) => m * power).find((v) => v >= value * 0.999);
}

function apart(one, other) {
  return Math.hypot(one[0] - other[0], one[1] - other[1]);
}
