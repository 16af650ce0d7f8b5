/* The rule base of the state: its variables, what can be drawn of it, its words. */

export const GAINS = { alpha: "α", beta: "β", gamma: "γ" };

/** All variables, inputs first. */
export function variables(rulebase) {
  return rulebase ? [...rulebase.inputs, ...rulebase.outputs] : [];
}

export function variable(rulebase, name) {
  return variables(rulebase).find((one) => one.name === name);
}

/** What a surface can show: the outputs, and the gains that follow from them. */
export function drawable(rulebase) {
  return rulebase?.surfaces ?? [];
}

/** A drawable by its sign: Greek for gains. */
export function signOf(name) {
  return GAINS[name] ?? name;
}

/** The consequents of a cell or rule for one output: [{set, confidence}]. */
export function consequents(cell, output) {
  return cell.parts.filter((part) => part.output === output);
}

/** A rule as it is shown: as written in a table, and in a list by output. */
export function wordsOf({ text, parts }, form) {
  if (form === "table") return text;
  return parts
    .map(({ output, set, confidence: sure }) => `${output} ${set}${sure === 1 ? "" : `@${sure}`}`)
    .join(", ");
}

/** Text of a cell in which `output` says `set` and the rest stays; null if it must be typed. */
export function withWord(cell, outputs, output, set) {
  const said = outputs.map((name) => (name === output ? [{ set }] : consequents(cell, name)));
  return joined(outputs, said.map((list) => list.map((one) => one.set)), confidence(cell));
}

/** Text of a cell with another confidence, likewise. */
export function withConfidence(cell, outputs, sure) {
  const said = outputs.map((name) => consequents(cell, name).map((one) => one.set));
  return joined(outputs, said, sure);
}

/** The one confidence of a cell, or null where it has several. */
export function confidence(cell) {
  return cell.weight;
}

function joined(outputs, said, sure) {
  if (sure === null || said.some((list) => list.length > 1)) return null;
  const known = outputs.filter((_, k) => said[k].length);
  const words = said.flat();
  const tail = sure === 1 ? "" : `@${sure}`;
  // A hyphen in a name would leave two ways to read the short form.
  const short = known.length === outputs.length && words.every((word) => /^\w+$/.test(word));
  if (short) return words.join("-") + tail;
  return `{${known.map((name, k) => `${name}: ${words[k]}${tail}`).join(", ")}}`;
}
