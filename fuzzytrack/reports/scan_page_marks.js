// Shapes and texts of the map, and where labels find a free place.

const LABEL = 12, NAMED = 300, CELL = 4;

// Which squares of the map are covered.
class Taken {
  constructor(width, height) {
    this.wide = Math.ceil(width / CELL) + 1;
    this.high = Math.ceil(height / CELL) + 1;
    this.cells = new Uint8Array(this.wide * this.high);
  }

  squares(box, visit) {
    const [left, top, right, bottom] = box.map((side) => Math.floor(side / CELL));
    for (let y = Math.max(0, top); y <= Math.min(bottom, this.high - 1); y++) {
      for (let x = Math.max(0, left); x <= Math.min(right, this.wide - 1); x++) {
        if (visit(y * this.wide + x)) return true;
      }
    }
    return false;
  }

  isFree(box) {
    return !this.squares(box, (cell) => this.cells[cell]);
  }

  take(box) {
    this.squares(box, (cell) => {
      this.cells[cell] = 1;
      return false;
    });
  }
}

function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].map((k) => k * power).find((length) => length <= most) ?? power;
}

function lengthText(meters) {
  return meters >= 1000 ? `${meters / 1000} km` : `${Number(meters.toPrecision(3))} m`;
}

// A disc for what moves, a square for what stands still, a diamond for what is undecided.
function shapeOf(pen, kind, x, y, radius) {
  if (kind === MOVING) pen.arc(x, y, radius, 0, 2 * Math.PI);
  else if (kind === STATIC) pen.rect(x - 0.75 * radius, y - 0.75 * radius, 1.5 * radius, 1.5 * radius);
  else {
    pen.moveTo(x, y - radius);
    pen.lineTo(x + radius, y);
    pen.lineTo(x, y + radius);
    pen.lineTo(x - radius, y);
    pen.closePath();
  }
}
