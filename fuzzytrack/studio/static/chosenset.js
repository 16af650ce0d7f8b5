/* The variable and the set that are looked at. */

import { variable, variables } from "./rulebase.js";

export function currentVariable({ state, variable: name }) {
  return variable(state?.rulebase, name) ?? variables(state?.rulebase)[0];
}

/** The name of the set; without a choice that in the middle. */
export function chosenSet(now) {
  const { sets } = currentVariable(now);
  return now.set ?? sets[Math.floor(sets.length / 2)].name;
}

/** The step of snapping and of the arrow keys. */
export function stepOf(now) {
  const [low, high, points] = currentVariable(now).universe;
  if (now.snap === "grid") return (high - low) / Math.max(1, points - 1);
  return (high - low) / (now.snap === "fine" ? 200 : 1000);
}
