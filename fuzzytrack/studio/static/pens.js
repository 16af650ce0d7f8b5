/* Pens that draw the same picture on a canvas and into an SVG file. */

/** Draws on a canvas of a size in CSS pixels. */
export class CanvasPen {
  constructor(context, font) {
    this.context = context;
    this.font = font;
  }

  /** A closed polygon [x, y, x, y, ...]; no stroke without a width. */
  polygon(points, fill, stroke = fill, width = 0) {
    const { context } = this;
    this.#path(points);
    context.closePath();
    if (fill) {
      context.fillStyle = fill;
      context.fill();
    }
    if (width) {
      context.strokeStyle = stroke;
      context.lineWidth = width;
      context.stroke();
    }
  }

  line(points, stroke, width = 1, dash = []) {
    const { context } = this;
    this.#path(points);
    context.strokeStyle = stroke;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
  }

  /** Separate strokes [x, y, x, y] after one another. */
  segments(points, stroke, width = 1) {
    const { context } = this;
    context.beginPath();
    for (let k = 0; k < points.length; k += 4) {
      context.moveTo(points[k], points[k + 1]);
      context.lineTo(points[k + 2], points[k + 3]);
    }
    context.strokeStyle = stroke;
    context.lineWidth = width;
    context.stroke();
  }

  circle(x, y, radius, fill, stroke, width = 1) {
    const { context } = this;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    if (fill) {
      context.fillStyle = fill;
      context.fill();
    }
    if (stroke) {
      context.strokeStyle = stroke;
      context.lineWidth = width;
      context.stroke();
    }
  }

  /** Text; `align` is start, middle or end, `turn` an angle in degrees. */
  text(x, y, words, { fill, align = "start", size = 11, turn = 0, halo = null, weight = 400 }) {
    const { context } = this;
    context.save();
    context.translate(x, y);
    context.rotate((turn * Math.PI) / 180);
    context.font = `${weight} ${size}px ${this.font}`;
    context.textAlign = align === "middle" ? "center" : align;
    context.textBaseline = "middle";
    if (halo) {
      context.strokeStyle = halo;
      context.lineWidth = 3;
      context.lineJoin = "round";
      context.strokeText(words, 0, 0);
    }
    context.fillStyle = fill;
    context.fillText(words, 0, 0);
    context.restore();
  }

  /** A small canvas, stretched smoothly. */
  image(canvas, x, y, width, height) {
    this.context.imageSmoothingQuality = "high";
    this.context.drawImage(canvas, x, y, width, height);
  }

  #path(points) {
    const { context } = this;
    context.beginPath();
    context.moveTo(points[0], points[1]);
    for (let k = 2; k < points.length; k += 2) context.lineTo(points[k], points[k + 1]);
  }
}

/** Writes SVG; `file()` is its text. */
export class SvgPen {
  constructor(width, height, background, font) {
    this.parts = [
      `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" ` +
        `viewBox="0 0 ${width} ${height}" font-family="${escape(font)}">`,
      `<rect width="${width}" height="${height}" fill="${background}"/>`,
    ];
  }

  polygon(points, fill, stroke = fill, width = 0) {
    const edge = width ? ` stroke="${stroke}" stroke-width="${width}"` : "";
    this.parts.push(`<polygon points="${pairs(points)}" fill="${fill ?? "none"}"${edge}/>`);
  }

  line(points, stroke, width = 1, dash = []) {
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    this.parts.push(
      `<polyline points="${pairs(points)}" fill="none" stroke="${stroke}" ` +
        `stroke-width="${width}"${dashes}/>`,
    );
  }

  segments(points, stroke, width = 1) {
    const strokes = [];
    for (let k = 0; k < points.length; k += 4) {
      const [x1, y1, x2, y2] = points.slice(k, k + 4).map(short);
      strokes.push(`M${x1} ${y1}L${x2} ${y2}`);
    }
    this.parts.push(
      `<path d="${strokes.join("")}" fill="none" stroke="${stroke}" stroke-width="${width}"/>`,
    );
  }

  circle(x, y, radius, fill, stroke, width = 1) {
    const edge = stroke ? ` stroke="${stroke}" stroke-width="${width}"` : "";
    this.parts.push(
      `<circle cx="${short(x)}" cy="${short(y)}" r="${radius}" fill="${fill ?? "none"}"${edge}/>`,
    );
  }

  text(x, y, words, { fill, align = "start", size = 11, turn = 0, halo = null, weight = 400 }) {
    const around = halo ? ` stroke="${halo}" stroke-width="3" paint-order="stroke"` : "";
    const turned = turn ? ` transform="rotate(${turn} ${short(x)} ${short(y)})"` : "";
    this.parts.push(
      `<text x="${short(x)}" y="${short(y)}" dy="0.35em" fill="${fill}" font-size="${size}" ` +
        `font-weight="${weight}" text-anchor="${align}"${around}${turned}>${escape(words)}</text>`,
    );
  }

  image(canvas, x, y, width, height) {
    this.parts.push(
      `<image x="${x}" y="${y}" width="${width}" height="${height}" ` +
        `preserveAspectRatio="none" href="${canvas.toDataURL()}"/>`,
    );
  }

  file() {
    return [...this.parts, "</svg>"].join("\n");
  }
}

function short(number) {
  return Number(number.toFixed(2));
}

function pairs(points) {
  const words = [];
  for (let k = 0; k < points.length; k += 2) words.push(`${short(points[k])},${short(points[k + 1])}`);
  return words.join(" ");
}

function escape(text) {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}
