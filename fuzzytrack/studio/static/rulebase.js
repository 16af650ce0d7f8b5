/* The rule base of the state: its variables, what can be drawn of it, its words. */

export const GAINS = { alpha: "α", beta: "β", gamma: "γ" };

/** All variables, inputs first. */
export function variables(rulebase) {
  return rulebase ? [...rulebase.inputs, ...rulebase.outputs] : [];
}

export function variable(rulebase, name) {
  return variables(rulebase).find((one) => one.name === name);
}

/** The inputs that surfaces are drawn over: those that were chosen, or the first two. */
export function axesOf({ inputs }, chosen) {
  const found = (chosen ?? []).map((name) => inputs.find((one) => one.name === name));
  return found.length && found.every(Boolean) ? found : inputs.slice(0, 2);
}

/** What a surface can show: the outputs, and the gains that follow from them. */
export function drawable(rulebase) {
  return rulebase?.surfaces ?? [];
}

/** A drawable by its sign: Greek for gains. */
export function signOf(name) {
  return GAINS[name] ?? name;
}

/** Whether a rule is edited in the text alone: its conclusions cannot be set by its conditions. */
export function isOfText(rule) {
  return Boolean(rule.or?.length);
}

/** The consequents of a cell or rule for one output: [{set, confidence}]. */
export function consequents(cell, output) {
  return cell.parts.filter((part) => part.output === output);
}

/**
 * A rule as it is shown, in pieces {text, output}: short in a table ("S-M/L", with the sign @ and a
 * number for a confidence below 1), by output in a list. Pieces that name sets have their output.
 */
export function piecesOf(rule, form, outputs) {
  if (form === "list") return listPieces(rule, outputs);
  const sets = outputs.map((output) => consequents(rule, output).map(({ set }) => set).join("/"));
  const pieces = sets.flatMap((text, k) => [{ text: k ? "-" : "" }, { text, output: outputs[k] }]);
  return rule.weight === 1 ? pieces : [...pieces, { text: `@${rule.weight ?? "…"}`, tail: true }];
}

function listPieces(rule, outputs) {
  const said = outputs.filter((output) => consequents(rule, output).length);
  return said.flatMap((output, k) => [
    { text: `${k ? ", " : ""}${output} ` },
    { text: consequents(rule, output).map(word).join("/"), output },
  ]);
}

/** A set with its confidence, as it is written. */
function word({ set, confidence }) {
  return confidence === 1 ? set : `${set}@${confidence}`;
}

/** The outputs in the order in which rules name them. */
export function outputsOf({ rules, outputs }) {
  return rules.outputs ?? outputs.map(({ name }) => name);
}

/** Text of a cell in which `output` says `set` alone; the other outputs stay. */
export function withWord(cell, outputs, output, set) {
  // Without a weight the cell has several confidences.
  const sure = cell.weight ?? 1;
  return textOf(outputs, (name) =>
    name === output ? [{ set, confidence: sure }] : consequents(cell, name),
  );
}

/**
 * Text of a cell in which an output says a set besides others, or no longer; they share it evenly. A
 * rule of a list may say nothing of an output, if it says something of another.
 */
export function withShare(cell, outputs, output, set, form) {
  const said = consequents(cell, output).map((one) => one.set);
  const sets = said.includes(set) ? said.filter((one) => one !== set) : [...said, set];
  if (!sets.length && (form === "table" || cell.parts.length < 2)) return cell.text;
  const share = Number((1 / sets.length).toFixed(3));
  return textOf(outputs, (name) =>
    name === output
      ? sets.map((one) => ({ set: one, confidence: share }))
      : consequents(cell, name),
  );
}

/** Text of a cell in which one of its consequents has another confidence. */
export function withConfidence(cell, outputs, { output, set }, confidence) {
  return textOf(outputs, (name) =>
    consequents(cell, name).map((one) => (name === output && one.set === set ? { ...one, confidence } : one)),
  );
}

/** The short form of a cell where it is enough, else that by output. */
function textOf(outputs, saidOf) {
  const said = outputs.map((name) => [name, saidOf(name)]).filter(([, parts]) => parts.length);
  const parts = said.flatMap(([, all]) => all);
  const even = parts.every((part) => part.confidence === parts[0].confidence);
  // A hyphen in a name would leave two ways to read the short form.
  const plain = parts.length === outputs.length && parts.every(({ set }) => /^\w+$/.test(set));
  if (even && plain && said.every(([, all]) => all.length === 1)) {
    return word({ ...parts[0], set: parts.map(({ set }) => set).join("-") });
  }
  const entries = said.map(([name, all]) => {
    const words = all.map(word).join(", ");
    return `${name}: ${all.length > 1 ? `[${words}]` : words}`;
  });
  return `{${entries.join(", ")}}`;
}
