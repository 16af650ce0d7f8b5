/* Colors of values and of words; every scale can be read with any color vision and in gray. */

// Twelve even steps of viridis (van der Walt and Smith 2015, CC0) and cividis (Nuñez et al. 2018).
const STOPS = {
  viridis: "440154481f704439833b528b31688e287c8e21918c20a48635b7795ec96290d743c8e020fde725",
  cividis: "00224e0031702a3f6d434e6c575d6d6a6c717d7c78918b78a59c74bcae6cd2c060e9d34efee838",
  gray: "1c1c1cf2f2f2",
  // From Okabe and Ito's blue through white to their vermilion.
  difference: "0072b26fb0d6f4f4f4e9a06bd55e00",
};

/** Names of the scales to choose from. */
export const PALETTES = ["viridis", "cividis", "gray"];

const scales = Object.fromEntries(
  Object.entries(STOPS).map(([name, hex]) => [name, lookup(hex.match(/.{6}/g).map(rgb))]),
);

function rgb(hex) {
  return [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

function lookup(stops) {
  return Array.from({ length: 256 }, (_, k) => {
    const place = (k / 255) * (stops.length - 1);
    const left = Math.min(Math.floor(place), stops.length - 2);
    return stops[left].map((part, i) => part + (stops[left + 1][i] - part) * (place - left));
  });
}

/** [red, green, blue] of a share from 0 to 1. */
export function color(palette, share) {
  return scales[palette][Math.max(0, Math.min(255, Math.round(share * 255)))];
}

/** A color as CSS, made darker by `light` below 1. */
export function css([red, green, blue], light = 1) {
  return `rgb(${Math.round(red * light)},${Math.round(green * light)},${Math.round(blue * light)})`;
}

/** A color mixed with another. */
export function mix(one, other, share) {
  return one.map((part, k) => part + (other[k] - part) * share);
}

/** Black or white, whichever can be read better on a color (WCAG relative luminance). */
export function ink(background) {
  const [red, green, blue] = background.map((part) => {
    const share = part / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  const luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  return luminance > 0.179 ? "#000" : "#fff";
}

/** Shares of the sets of a variable, evenly from 0 to 1 in the order of their names. */
export function shareOf(variable, set) {
  const place = variable.sets.findIndex(({ name }) => name === set);
  return variable.sets.length > 1 ? place / (variable.sets.length - 1) : 0.5;
}

/** Color of a line or text on the page for a share: the ends that vanish on it are left out. */
export function lineColor(palette, share) {
  const dark = document.documentElement.dataset.scheme === "dark";
  return css(color(palette, dark ? 0.38 + 0.6 * share : 0.72 * share));
}

/** A custom property of the page, such as "--ink". */
export function token(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
