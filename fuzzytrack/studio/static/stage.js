/* A canvas that fills its box, sharp on any screen, and is drawn at most once a frame. */

import { CanvasPen, SvgPen } from "./pens.js";
import { token } from "./colors.js";

/** `draw(pen, width, height)` draws the picture in CSS pixels; `after()` is called on the frame. */
export function makeStage(canvas, draw, after = () => {}) {
  const context = canvas.getContext("2d");
  let asked = false;

  function redraw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const { clientWidth: width, clientHeight: height } = canvas;
      if (!width || !height) return;
      const dense = window.devicePixelRatio || 1;
      const [columns, rows] = [Math.round(width * dense), Math.round(height * dense)];
      if (canvas.width !== columns || canvas.height !== rows) {
        canvas.width = columns;
        canvas.height = rows;
      }
      context.setTransform(dense, 0, 0, dense, 0, 0);
      context.clearRect(0, 0, width, height);
      draw(new CanvasPen(context, fontOf(canvas)), width, height);
      after();
    });
  }

  /** The same picture as the text of an SVG file. */
  function file() {
    const { clientWidth: width, clientHeight: height } = canvas;
    const pen = new SvgPen(width, height, token("--panel"), fontOf(canvas));
    draw(pen, width, height);
    return pen.file();
  }

  new ResizeObserver(redraw).observe(canvas);
  return { redraw, file };
}

function fontOf(element) {
  return getComputedStyle(element).fontFamily;
}
