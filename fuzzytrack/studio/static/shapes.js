/* Membership shapes: grades for drawing, the corners that can be dragged, changes of shape. */

// A Gaussian is at one half this many sigma from its mean.
const HALF = Math.sqrt(2 * Math.log(2));
const AT_SIGMA = Math.exp(-0.5);

/* A corner: the parameter it moves, its grade, and where it is (unless it is the parameter). */
const at = (index, grade, name) => ({
  index,
  grade,
  name,
  place: (p) => p[index],
  moved: (p, x) => p.with(index, x),
});

function width(index, mean, side, grade, name) {
  return {
    index,
    grade,
    name,
    place: (p) => p[mean] + side * p[index],
    moved: (p, x) => p.with(index, side * (x - p[mean])),
  };
}

const gaussian = (x, mean, sigma) => Math.exp(-((x - mean) ** 2) / (2 * sigma * sigma));

function trapezoid(x, [a, b, c, d]) {
  if (x >= b && x <= c) return 1;
  const rise = x < b ? (x - a) / (b - a) : 1;
  const fall = x > c ? (d - x) / (d - c) : 1;
  return Math.max(0, Math.min(rise, fall));
}

function sCurve(x, a, b) {
  if (x >= b) return 1;
  if (x <= a) return 0;
  const share = (x - a) / (b - a);
  return share < 0.5 ? 2 * share * share : 1 - 2 * (1 - share) * (1 - share);
}

// `quad` are the corners of the trapezoid that is nearest to the shape, by which shapes change;
// `made` makes the parameters of the shape from such corners.
export const SHAPES = {
  trimf: {
    title: "triangle",
    parameters: ["a", "b", "c"],
    corners: [at(0, 0, "left foot"), at(1, 1, "peak"), at(2, 0, "right foot")],
    grade: (x, [a, b, c]) => trapezoid(x, [a, b, b, c]),
    quad: ([a, b, c]) => [a, b, b, c],
    made: ([a, b, c, d]) => [a, (b + c) / 2, d],
    ordered: true,
  },
  trapmf: {
    title: "trapezoid",
    parameters: ["a", "b", "c", "d"],
    corners: [
      at(0, 0, "left foot"), at(1, 1, "left shoulder"),
      at(2, 1, "right shoulder"), at(3, 0, "right foot"),
    ],
    grade: trapezoid,
    quad: (p) => p,
    made: (p) => p,
    ordered: true,
  },
  gaussmf: {
    title: "Gaussian",
    parameters: ["mean", "sigma"],
    corners: [at(0, 1, "mean"), width(1, 0, 1, AT_SIGMA, "sigma")],
    grade: (x, [mean, sigma]) => gaussian(x, mean, sigma),
    quad: ([mean, sigma]) => [mean - 2 * HALF * sigma, mean, mean, mean + 2 * HALF * sigma],
    made: ([a, b, c, d]) => [(b + c) / 2, (c + d - a - b) / 4 / HALF],
    positive: [1],
  },
  gauss2mf: {
    title: "two Gaussians",
    parameters: ["mean1", "sigma1", "mean2", "sigma2"],
    corners: [
      width(1, 0, -1, AT_SIGMA, "left sigma"), at(0, 1, "left mean"),
      at(2, 1, "right mean"), width(3, 2, 1, AT_SIGMA, "right sigma"),
    ],
    grade: (x, [mean1, sigma1, mean2, sigma2]) =>
      (x < mean1 ? gaussian(x, mean1, sigma1) : 1) * (x > mean2 ? gaussian(x, mean2, sigma2) : 1),
    quad: (p) => [p[0] - 2 * HALF * p[1], p[0], p[2], p[2] + 2 * HALF * p[3]],
    made: ([a, b, c, d]) => [b, (b - a) / 2 / HALF, c, (d - c) / 2 / HALF],
    positive: [1, 3],
  },
  gbellmf: {
    title: "bell",
    parameters: ["a", "b", "c"],
    corners: [at(2, 1, "center"), width(0, 2, 1, 0.5, "half width")],
    grade: (x, [a, b, c]) => 1 / (1 + Math.abs((x - c) / a) ** (2 * b)),
    quad: ([a, b, c]) => [c - a - a / b, c - a + a / b, c + a - a / b, c + a + a / b],
    made: ([a, b, c, d]) => [(c + d - a - b) / 4, 2, (a + b + c + d) / 4],
    positive: [0, 1],
    fixed: [1],
  },
  sigmf: {
    title: "sigmoid",
    parameters: ["b", "c"],
    corners: [
      at(0, 0.5, "middle"),
      {
        index: 1,
        grade: 1 / (1 + Math.exp(-2)),
        name: "slope",
        place: ([b, c]) => b + 2 / c,
        moved: ([b], x) => [b, 2 / (x - b)],
      },
    ],
    grade: (x, [b, c]) => 1 / (1 + Math.exp(-c * (x - b))),
    quad: ([b, c]) => [b - 2 / Math.abs(c), b + 2 / Math.abs(c), b + 4 / c, b + 4 / c],
    made: ([a, b]) => [(a + b) / 2, 4 / (b - a)],
    fixed: [1],
  },
  smf: {
    title: "S curve",
    parameters: ["a", "b"],
    corners: [at(0, 0, "foot"), at(1, 1, "shoulder")],
    grade: (x, [a, b]) => sCurve(x, a, b),
    quad: ([a, b]) => [a, b, b, b],
    made: ([a, b]) => [a, b],
    ordered: true,
  },
  zmf: {
    title: "Z curve",
    parameters: ["a", "b"],
    corners: [at(0, 1, "shoulder"), at(1, 0, "foot")],
    grade: (x, [a, b]) => 1 - sCurve(x, a, b),
    quad: ([a, b]) => [a, a, a, b],
    made: ([, , c, d]) => [c, d],
    ordered: true,
  },
  pimf: {
    title: "Pi curve",
    parameters: ["a", "b", "c", "d"],
    corners: [
      at(0, 0, "left foot"), at(1, 1, "left shoulder"),
      at(2, 1, "right shoulder"), at(3, 0, "right foot"),
    ],
    grade: (x, [a, b, c, d]) => sCurve(x, a, b) * (1 - sCurve(x, c, d)),
    quad: (p) => p,
    made: (p) => p,
    ordered: true,
  },
  singleton: {
    title: "singleton",
    parameters: ["value"],
    corners: [at(0, 1, "value")],
    grade: (x, [value]) => (x === value ? 1 : 0),
    quad: ([value]) => [value, value, value, value],
    made: ([, b, c]) => [(b + c) / 2],
    ordered: true,
  },
};

/** How a set is drawn. One of a shape that is not known here has no corners, and the server's curve. */
export function shapeOf(set) {
  return SHAPES[set.shape] ?? curveOf(set);
}

export function isDrawn({ shape }) {
  return shape in SHAPES;
}

function curveOf({ shape, names, grades, core, universe: [low, high] }) {
  const grade = (x) => {
    const at = Math.max(0, Math.min(1, (x - low) / (high - low))) * (grades.length - 1);
    const k = Math.min(grades.length - 2, Math.floor(at));
    return grades.length ? grades[k] + (grades[k + 1] - grades[k]) * (at - k) : NaN;
  };
  const [start, end] = core ?? [NaN, NaN];
  return { title: shape, parameters: names, corners: [], grade, quad: () => [start, start, end, end] };
}

/** Parameters with one corner moved to `x`, as far as its neighbors let it. */
export function moved({ shape, parameters }, corner, x, least) {
  const kind = SHAPES[shape];
  let next = corner.moved(parameters, x);
  if (kind.ordered) {
    const low = parameters[corner.index - 1] ?? -Infinity;
    const high = parameters[corner.index + 1] ?? Infinity;
    next = parameters.with(corner.index, Math.min(high, Math.max(low, x)));
  } else if (shape === "gauss2mf" && corner.index % 2 === 0) {
    const stop = corner.index === 0 ? Math.min : Math.max;
    next = parameters.with(corner.index, stop(x, parameters[2 - corner.index]));
  }
  for (const index of kind.positive ?? []) next = next.with(index, Math.max(least, next[index]));
  return next.every(Number.isFinite) ? next : parameters;
}

/** Parameters of the whole set moved by `step`. */
export function shifted({ shape, parameters }, step) {
  const kind = SHAPES[shape];
  const still = [...(kind.positive ?? []), ...(kind.fixed ?? [])];
  return parameters.map((p, k) => (still.includes(k) ? p : p + step));
}

/** The set mirrored about `middle`. */
export function mirrored({ shape, parameters }, middle) {
  const turn = (x) => 2 * middle - x;
  if (shape === "gauss2mf") {
    const [mean1, sigma1, mean2, sigma2] = parameters;
    return { shape, parameters: [turn(mean2), sigma2, turn(mean1), sigma1] };
  }
  if (shape === "gaussmf") return { shape, parameters: [turn(parameters[0]), parameters[1]] };
  if (shape === "gbellmf") return { shape, parameters: parameters.with(2, turn(parameters[2])) };
  if (shape === "sigmf") return { shape, parameters: [turn(parameters[0]), -parameters[1]] };
  const other = { smf: "zmf", zmf: "smf" }[shape] ?? shape;
  return { shape: other, parameters: parameters.map(turn).reverse() };
}

/** The parameters of another shape that lies where this one does. */
export function reshaped({ shape, parameters }, wanted, least) {
  const [a, b, c, d] = SHAPES[shape].quad(parameters);
  const made = SHAPES[wanted].made([a, b, c, d]);
  const positive = SHAPES[wanted].positive ?? [];
  if (wanted === "sigmf" && !Number.isFinite(made[1])) made[1] = 1 / least;
  return made.map((p, k) => (positive.includes(k) ? Math.max(least, p) : p));
}
