/* Cells of the rules: their places, the rows they stand in, their colors and words. */

import { color, css, ink, mix, shareOf, token } from "./colors.js";
import { html } from "./elements.js";
import { SvgPen } from "./pens.js";

export function tableSlots({ rows, columns, row_sets: down, column_sets: across }) {
  return down.flatMap((row, y) =>
    across.map((column, x) => ({
      x,
      y,
      key: `${y},${x}`,
      place: { row, column },
      name: `${columns} ${column}, ${rows} ${row}`,
      rule: (rules) => rules.cells[y][x],
    })),
  );
}

export function listSlots({ rules: all }) {
  return all.map((rule, y) => ({
    x: 0,
    y,
    key: String(y),
    place: { rule: y },
    name: `Rule ${y + 1}`,
    rule: (rules) => rules.rules[y],
  }));
}

/** The key of a rule, as `store.cell` has it: "row,column" of a table, or the index in a list. */
export function placeKey(place, index) {
  return place ? place.join() : String(index);
}

// ---------------------------------------------------------------------- rows

export function tableRows({ rules }, slots) {
  const { rows, columns, row_sets: down, column_sets: across } = rules;
  const head = html(
    "tr",
    { role: "row" },
    html("th", { class: "corner", scope: "col" }, html("span", {}, rows, " ╲ ", columns)),
    across.map((name) => html("th", { scope: "col", role: "columnheader" }, name)),
  );
  const lines = down.map((name, y) =>
    html(
      "tr",
      { role: "row" },
      html("th", { scope: "row", role: "rowheader" }, name),
      slots.filter((slot) => slot.y === y).map(({ td }) => td),
    ),
  );
  return [html("thead", { role: "rowgroup" }, head), html("tbody", { role: "rowgroup" }, lines)];
}

export function listRows({ inputs, rules }, slots) {
  const head = html(
    "tr",
    { role: "row" },
    ["", ...inputs.map(({ name }) => `if ${name}`), "then"].map((text) =>
      html("th", { scope: "col", role: "columnheader" }, text),
    ),
  );
  // Conditions after `or` are lines of their own.
  const lines = rules.rules.map(({ if: conditions, or: others }, y) =>
    html(
      "tr",
      { role: "row" },
      html("th", { scope: "row", role: "rowheader" }, inLines([String(y + 1), ...others.map(() => "or")])),
      inputs.map(({ name }) => {
        const asked = [conditions, ...others].map((group) => group[name]);
        return html(
          "td",
          { role: "gridcell", class: asked.some(Boolean) ? "if" : "if none" },
          inLines(asked.map((set) => set ?? "any")),
        );
      }),
      slots[y].td,
    ),
  );
  return [html("thead", { role: "rowgroup" }, head), html("tbody", { role: "rowgroup" }, lines)];
}

function inLines(words) {
  return words.length > 1 ? words.map((word) => html("div", {}, word)) : words;
}

// ---------------------------------------------------------------------- one cell

/** Color a cell by its sets of one output; several share it by their confidences. */
export function tint({ td }, target, said, palette) {
  const ground = token("--panel").match(/\w\w/g).map((part) => parseInt(part, 16));
  const paints = said.map(({ set, confidence: sure }) =>
    mix(ground, color(palette, shareOf(target, set)), 0.25 + 0.75 * sure),
  );
  const total = said.reduce((sum, one) => sum + one.confidence, 0) || 1;
  let from = 0;
  const stops = paints.map((paint, k) => {
    const to = from + (100 * said[k].confidence) / total;
    const stop = `${css(paint)} ${from}% ${to}%`;
    from = to;
    return stop;
  });
  td.style.background = stops.length > 1 ? `linear-gradient(90deg, ${stops})` : "";
  if (stops.length === 1) td.style.background = css(paints[0]);
  td.classList.toggle("split", stops.length > 1);
  td.style.color = stops.length === 1 ? ink(paints[0]) : "";
}

/** The words of a cell, those of the colored output bold. */
export function write(box, pieces, output) {
  const known = JSON.stringify([pieces, output]);
  if (box.dataset.known === known) return;
  box.dataset.known = known;
  box.replaceChildren(
    ...pieces.map((piece) => {
      if (piece.tail) return html("small", {}, piece.text);
      return piece.output === output ? html("b", {}, piece.text) : piece.text;
    }),
  );
}

export function spoken({ name }, rule, strength, complaint) {
  const fires = strength ? `, fires with ${strength.toFixed(2)}` : "";
  return `${name}: ${rule.text}${fires}${complaint ? `. ${complaint}` : ""}`;
}

/** The table as the text of an SVG file, as it is on the page. */
export function tableFile(grid) {
  const box = grid.getBoundingClientRect();
  const font = getComputedStyle(grid).fontFamily;
  const pen = new SvgPen(Math.ceil(box.width), Math.ceil(box.height), token("--panel"), font);
  for (const cell of grid.querySelectorAll("th, td")) {
    const { left, top, width, height } = cell.getBoundingClientRect();
    const [x, y] = [left - box.left, top - box.top];
    const { color: fill, backgroundColor } = getComputedStyle(cell);
    pen.polygon([x, y, x + width, y, x + width, y + height, x, y + height], backgroundColor);
    pen.text(x + width / 2, y + height / 2, cell.textContent, { fill, align: "middle", size: 12 });
  }
  return pen.file();
}
