/* Numbers as they are shown and typed, and ticks of axes. */

// From here on a number has an exponent, or its zeros would take the room of the picture.
const [TINY, HUGE] = [1e-4, 1e7];

/** A number with at most so many significant digits and a true minus sign. */
export function shown(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  const text = size >= HUGE || (size > 0 && size < TINY) ? rounded.toExponential() : String(rounded);
  return text.replaceAll("-", "−").replace("+", "");
}

/** A number with all its significant digits, trailing zeros too, so that a column is aligned. */
export function even(value, digits) {
  if (Math.abs(value) >= HUGE) return shown(value, digits);
  return value === 0 ? "0" : withPlaces(value, placesOf(value, digits));
}

/** Decimal places with which a number has so many significant digits. */
export function placesOf(value, digits) {
  return Math.min(12, Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value)))));
}

/** A number with so many decimal places and a true minus sign. */
export function withPlaces(value, places) {
  return value.toFixed(places).replace("-", "−");
}

/** A typed number; a decimal comma and the true minus sign are taken too. NaN if it is none. */
export function typed(text) {
  const plain = text.trim().replaceAll("−", "-").replace(",", ".");
  return plain === "" ? NaN : Number(plain);
}

/** Drop the noise of floating point, which would stand in the file otherwise. */
export function tidy(value) {
  return Number(value.toPrecision(12));
}

/** Round numbers within [low, high], about `count` of them. */
export function ticks(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => tidy((first + k) * step));
}

/** Least and largest finite number, a little apart if they are equal. */
export function span(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  // float32: a constant surface has noise in its last digits.
  if (high - low <= 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1e-6)) {
    const margin = 0.01 * Math.max(Math.abs(low), 1e-3);
    return [low - margin, high + margin];
  }
  return [low, high];
}
