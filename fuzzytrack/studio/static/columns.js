/* What is said of a recording: which columns are what, and its faults; and the same in messages. */

// The kinds of positions: the argument that takes their columns, what these are called, and the
// noise of such plots: its argument, name and unit.
export const POSITIONS = {
  axes: { text: "x, y", places: ["x", "y", "z"], noise: [["sigma", "Plot σ", "m"]] },
  polar: {
    text: "range, azimuth",
    places: ["Range", "Azimuth", "Elevation"],
    noise: [
      ["sigma_range", "Range σ", "m"],
      ["sigma_azimuth", "Azimuth σ", "°"],
      ["sigma_elevation", "Elevation σ", "°"],
    ],
  },
  geodetic: {
    text: "latitude, longitude",
    places: ["Latitude", "Longitude", "Altitude"],
    noise: [["sigma", "Plot σ", "m"]],
  },
};

/** What is said of a recording of which nothing is said. */
export const NOTHING = {
  time: "", id: "", position: "axes", places: ["", "", ""], truth: "", noise: {}, own_ship: ["", "", ""],
  own_heading: "", azimuth_from: "", time_unit: "", wrap: null, duplicates: "", max_gap: null, sort: false,
};

const LABELS = {
  time: "Time column",
  id: "Track column",
  axes: "Positions x, y",
  polar: "Positions range, azimuth",
  geodetic: "Positions latitude, longitude",
  truth: "Truth",
  sigma: "Plot σ",
  sigma_range: "Range σ",
  sigma_azimuth: "Azimuth σ",
  sigma_elevation: "Elevation σ",
  azimuth_from: "Azimuth from",
  own_ship: "Own position",
  own_heading: "Own heading",
  time_unit: "Unit of time",
  wrap: "Clock restarts after",
  duplicates: "Plots at equal times",
  max_gap: "Longest gap",
  sort: "Sort by time",
  trackers: "Trackers",
  tracker: "Tracker",
  free: "Numbers to tune",
  trials: "Trials",
  folds: "Folds",
  runs: "Runs",
};
// What columns are used as, in the words of a button.
const USES = {
  time: "the time column",
  id: "the track column",
  axes: "x and y",
  polar: "range and azimuth",
  geodetic: "latitude and longitude",
};
const PROPOSAL = /; `(\w+)`=([^\s;]+)[^;]*/g;
const ARGUMENT = /^(\w+)(?=: )|`(\w+)`(?:=([^\s;]+))?/g;

/** What is said of the recording that is chosen. */
export function readingOf({ recording, readings }) {
  return { ...NOTHING, ...readings[recording] };
}

/** The same as commands take it. */
export function argumentsOf(now) {
  const { position, places, noise, truth, own_ship: own, ...rest } = readingOf(now);
  const given = { ...rest };
  // One column of a place says nothing yet.
  if (own[0] && own[1]) given.own_ship = own.filter((name) => name !== "");
  const named = places.filter((place) => place !== "");
  if (named.length) given[position] = named;
  if (truth) given.truth = truth.split(",").map((word) => word.trim());
  for (const [key] of POSITIONS[position].noise) given[key] = noise[key];
  if (position !== "polar") delete given.azimuth_from;
  const isGiven = (value) => value !== "" && value !== null && value !== undefined && value !== false;
  return Object.fromEntries(Object.entries(given).filter(([, value]) => isGiven(value)));
}

/** A message about arguments with the names of the fields of the page. */
export function inFields(text) {
  return text.replace(ARGUMENT, (all, first, quoted, value) => {
    const name = first ?? quoted;
    const label = LABELS[name];
    if (first) return label ?? first;
    const said = label ? `“${label}”` : `--${name.replaceAll("_", "-")} of the command line`;
    return value === undefined ? said : `${said} (${value})`;
  });
}

/** A message without what it proposes to say of a recording, and the proposals: [[text, change]]. */
export function remedies(text) {
  const found = [];
  const rest = text.replace(PROPOSAL, (all, name, value) => {
    const change = changeOf(name, value);
    if (!change) return all;
    found.push([`Use ${value.replaceAll(",", ", ")} as ${USES[name]}`, change]);
    return "";
  });
  return [rest, found];
}

function changeOf(name, value) {
  if (name === "time" || name === "id") return { [name]: value };
  if (!POSITIONS[name]) return null;
  const words = value.split(",");
  return { position: name, places: [0, 1, 2].map((k) => words[k] ?? "") };
}
