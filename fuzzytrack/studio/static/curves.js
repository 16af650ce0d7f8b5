/* Curves and tracks of results, as charts and maps take them. */

/** Names of the trackers in the order of their colors. */
export function namesOf(results) {
  return results.trackers.map(({ name }) => name);
}

/** The trackers that are shown, [[name, index], ...]. */
export function linesOf({ results, hidden }) {
  return namesOf(results)
    .map((name, index) => [name, index])
    .filter(([name]) => !hidden.includes(name));
}

/** Curves of the error of prediction or estimate, with a band, of the trackers that are shown. */
export function errorsOf({ results, hidden, quantity, band }) {
  const series = namesOf(results).flatMap((name, index) => {
    if (hidden.includes(name)) return [];
    const curve = results.curves[name];
    const y = curve[`${quantity}_rmse`];
    const se = curve[`${quantity}_rmse_se`];
    // No band of the spread is known of estimates.
    const spread = band === "spread" && quantity === "predicted" ? results.bands?.[name] : null;
    const low = spread?.low ?? y.map((value, k) => margin(value, se?.[k], -2));
    const high = spread?.high ?? y.map((value, k) => margin(value, se?.[k], 2));
    return [{ name, index, x: results.time, y, low, high }];
  });
  return {
    name: "Error over time",
    x: { label: "time (s)" },
    y: { label: `RMSE ${quantity} (m)`, low: 0 },
    series,
  };
}

function margin(value, error, times) {
  return finite(value) && finite(error) ? Math.max(0, value + times * error) : null;
}

/** The first run on a map, of the trackers that are shown. */
export function trajectoriesOf({ results, hidden }) {
  if (!results) return {};
  const { time, truth, plots, seen, trackers } = results.sample;
  const coasted = seen.map((each) => !each);
  const lines = namesOf(results).flatMap((name, index) =>
    hidden.includes(name) || !trackers[name]
      ? []
      : [{ name, index, points: trackers[name].filtered, coasted }],
  );
  return { time, truth, plots, lines };
}

/** The gain of the first axis; a gain may be a number for all axes. */
export function first(gain) {
  return Array.isArray(gain) ? gain[0] : gain;
}

/** Whether a value is a number: JSON has null for those that are not. */
export function finite(value) {
  return typeof value === "number" && Number.isFinite(value);
}
