/* The focus of the keyboard: kept while parts are drawn anew, moved by arrows, never lost. */

const CONTROLS = "button, input, select, summary, [tabindex='0']";

/** Redraw a part of the page. If the focus was in it, the control at the same place has it again. */
export function keepFocus(part, redraw) {
  const controls = () => [...part.querySelectorAll(CONTROLS)].filter((one) => one.checkVisibility());
  const at = controls().indexOf(document.activeElement);
  redraw();
  const left = controls();
  if (at >= 0 && !part.contains(document.activeElement)) left[Math.min(at, left.length - 1)]?.focus();
}

/** Let the arrow keys, Home and End go through the buttons of a row or column. */
export function goByArrows(element) {
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
    const all = [...element.querySelectorAll("button")].filter((button) => button.offsetParent);
    const at = all.indexOf(event.target);
    const step = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    const to = { Home: 0, End: all.length - 1 }[event.key] ?? at + step;
    if (at < 0 || Number.isNaN(to)) return;
    event.preventDefault();
    all[(to + all.length) % all.length].focus();
  });
}

/** Whether a button can be pressed; it keeps the focus when it no longer can. */
export function enable(button, on) {
  button.setAttribute("aria-disabled", String(!on));
}

export function isEnabled(button) {
  return button.getAttribute("aria-disabled") !== "true";
}

/** Esc in a field takes back what was typed and not sent yet. */
export function takeBackByEscape() {
  const before = new WeakMap();
  document.addEventListener("beforeinput", ({ target }) => {
    if (target.type === "text" && !before.has(target)) before.set(target, target.value);
  });
  for (const end of ["change", "focusout"]) {
    document.addEventListener(end, ({ target }) => before.delete(target));
  }
  document.addEventListener("keydown", ({ key, target, defaultPrevented }) => {
    if (key !== "Escape" || defaultPrevented || !before.has(target)) return;
    target.value = before.get(target);
    before.delete(target);
  });
}
