/* Line drawings for buttons, 16 by 16, in the color of the text. */

import { svg } from "./elements.js";

const PATHS = {
  down: "M4 6.5l4 4 4-4",
  table: "M2 3h12v10H2zM2 6.5h12M2 10h12M6 3v10M10 3v10",
  surface: "M2 11l5 3 7-4-5-3zM2 11c1-5 3-7 5-7s3 3 7 6M7 14c0-4 1-6 2-7",
  map: "M2 4l4-1.5 4 1.5 4-1.5v9.5L10 13.5 6 12 2 13.5zM6 2.5V12M10 4v9.5",
  run: "M5 3l8 5-8 5z",
  data: "M3 4c0-2.6 10-2.6 10 0v8c0 2.6-10 2.6-10 0zM3 4c0 2.6 10 2.6 10 0M3 8c0 2.6 10 2.6 10 0",
  undo: "M6 3L2.5 6.5 6 10M3 6.5h6a4 3.5 0 0 1 0 7H6",
  redo: "M10 3l3.5 3.5L10 10M13 6.5H7a4 3.5 0 0 0 0 7h3",
  save: "M3 2.5h8L13.5 5v8.5h-11v-11zM5 2.5V6h5.5V2.5M5 13.5V9.5h6v4",
  open: "M2 13V3.5h4l1.5 2H14V13zM2 7.5h12",
  picture: "M8 2.5v7M5 7l3 3 3-3M2.5 10v3.5h11V10",
  scheme: "M8 2a6 6 0 1 0 0 12zM8 2a6 6 0 0 1 0 12",
  help: "M5.5 6a2.5 2.5 0 1 1 3.5 2.2c-.7.4-1 .8-1 1.8M8 12.5v.6",
  add: "M8 3v10M3 8h10",
  remove: "M3.5 3.5l9 9M12.5 3.5l-9 9",
  home: "M3 8a5 5 0 1 0 1.6-3.7M3 2.5V5.5h3",
};

/** An icon; buttons with nothing else need a name of their own. */
export function icon(name) {
  return svg(
    "svg",
    { class: "icon", viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true" },
    svg("path", { d: PATHS[name] }),
  );
}
