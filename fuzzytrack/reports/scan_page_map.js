// The map: a view of the plane that can be moved, and what is drawn in it.

class RadarMap {
  constructor(canvas, run) {
    this.canvas = canvas;
    this.run = run;
    this.context = canvas.getContext("2d");
    this.colors = {};
    this.readColors();
    this.vector = this.vectorSeconds();
    this.moved = false;
    this.measure();
    this.fit();
  }

  readColors() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["ink", "soft", "page", "sea", "ring", "moving", "static", "undecided",
      "plot", "truth", "own", "chosen"]) {
      this.colors[name] = style.getPropertyValue(`--${name}`).trim();
    }
  }

  // Time for which a track's velocity is drawn: it is then a twelfth of the map or less.
  vectorSeconds() {
    const speeds = [];
    const every = 1 + (this.run.track.length >> 14);
    for (let row = 0; row < this.run.track.length; row += every) {
      if (this.run.kind[row] === MOVING) speeds.push(this.run.speed(row));
    }
    speeds.sort((a, b) => a - b);
    const fast = speeds[Math.floor(0.9 * speeds.length)] || 1;
    const [x, y] = this.run.extent();
    const wide = Math.max(x[1] - x[0], y[1] - y[0], 1);
    // Shorter where there are many.
    const parts = Math.max(12, 0.7 * Math.sqrt(this.run.track.length / Math.max(1, this.run.scans)));
    return roundLength(Math.max(1, wide / parts / Math.max(fast, 0.1)));
  }

  // ---------------------------------------------------------------- view

  // Reading it lays the page out, so it is read once for a picture.
  measure() {
    this.size = [this.canvas.clientWidth || 1, this.canvas.clientHeight || 1];
  }

  fit() {
    const [x, y] = this.run.extent();
    const [width, height] = this.size;
    const wide = Math.max(x[1] - x[0], 1), high = Math.max(y[1] - y[0], 1);
    this.scale = Math.min((width - 80) / wide, (height - 80) / high);
    if (!(this.scale > 0)) this.scale = 1;
    this.middle = [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2];
    this.moved = false;
  }

  toPixels(x, y) {
    const [width, height] = this.size;
    return [width / 2 + (x - this.middle[0]) * this.scale,
      height / 2 - (y - this.middle[1]) * this.scale];
  }

  zoom(factor, px, py) {
    const [width, height] = this.size;
    px ??= width / 2;
    py ??= height / 2;
    const scale = Math.min(1e4, Math.max(1e-7, this.scale * factor));
    const change = 1 / this.scale - 1 / scale;
    this.middle[0] += (px - width / 2) * change;
    this.middle[1] -= (py - height / 2) * change;
    this.scale = scale;
    this.moved = true;
  }

  pan(dx, dy) {
    this.middle[0] -= dx / this.scale;
    this.middle[1] += dy / this.scale;
    this.moved = true;
  }

  // Track whose mark is nearest to a place on the screen, or -1.
  pick(px, py, state) {
    let best = -1, least = 16 * 16;
    for (const row of this.shownRows(state)) {
      const [x, y] = this.pixelsOf(row);
      const far = (x - px) ** 2 + (y - py) ** 2;
      if (far < least) [best, least] = [this.run.track[row], far];
    }
    return best;
  }

  shownRows(state) {
    const rows = [];
    for (let row = this.run.rowsFrom[state.scan]; row < this.run.rowsFrom[state.scan + 1]; row++) {
      const hidden = (this.run.kind[row] === STATIC && !state.static) ||
        (this.run.status[row] === TENTATIVE && !state.tentative);
      if (!hidden) rows.push(row);
    }
    return rows;
  }

  // ---------------------------------------------------------------- drawing

  draw(state) {
    this.measure();
    const [width, height] = this.size, dots = window.devicePixelRatio || 1;
    const wide = Math.round(width * dots), high = Math.round(height * dots);
    if (this.canvas.width !== wide || this.canvas.height !== high) {
      this.canvas.width = wide;
      this.canvas.height = high;
      if (!this.moved) this.fit();
    }
    const pen = this.context;
    pen.setTransform(dots, 0, 0, dots, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.drawRings(state);
    if (state.plots) this.drawPlots(state);
    if (state.truth) this.drawTruth(state);
    const rows = this.shownRows(state);
    this.radius = rows.length < 300 ? 4.5 : rows.length < 3000 ? 3 : 1.8;
    this.drawTrails(rows, state);
    this.drawOwn(state);
    for (const row of rows) this.drawTrack(row, state);
    this.drawLabels(rows, state);
    this.drawScale();
  }

  // Rings about the own ship at round distances.
  drawRings(state) {
    const pen = this.context, [width, height] = this.size;
    const [x, y] = this.ownAt(state);
    const corners = [[0, 0], [width, 0], [0, height], [width, height]];
    const most = Math.max(...corners.map(([a, b]) => Math.hypot(a - x, b - y)));
    const step = roundLength(Math.max(width, height) / this.scale / 3);
    pen.strokeStyle = this.colors.ring;
    pen.fillStyle = this.colors.soft;
    pen.lineWidth = 1;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    for (let k = 1; k * step * this.scale < most && k < 40; k++) {
      const radius = k * step * this.scale;
      pen.beginPath();
      pen.arc(x, y, radius, 0, 2 * Math.PI);
      pen.stroke();
      pen.globalAlpha = y - radius < 16 ? 0 : 0.75;
      pen.fillText(lengthText(Number((k * step).toPrecision(6))), x, y - radius - 3);
      pen.globalAlpha = 1;
    }
  }

  ownAt(state) {
    return this.toPixels(this.run.own[2 * state.scan], this.run.own[2 * state.scan + 1]);
  }

  // Plots of this scan, and those of the four before ever fainter.
  drawPlots(state) {
    const pen = this.context, [width, height] = this.size;
    pen.fillStyle = this.colors.plot;
    for (let age = Math.min(4, state.scan); age >= 0; age--) {
      const scan = state.scan - age, size = age ? 2 : 3.2;
      pen.globalAlpha = age ? 0.4 - 0.07 * age : 0.75;
      for (let k = this.run.plotsFrom[scan]; k < this.run.plotsFrom[scan + 1]; k++) {
        const [x, y] = this.toPixels(this.run.plots[2 * k], this.run.plots[2 * k + 1]);
        if (x < 0 || y < 0 || x > width || y > height) continue;
        pen.fillRect(x - size / 2, y - size / 2, size, size);
      }
    }
    pen.globalAlpha = 1;
  }

  drawTruth(state) {
    const pen = this.context, time = this.run.times[state.scan];
    pen.strokeStyle = pen.fillStyle = this.colors.truth;
    for (let target = 0; target < this.run.truthFrom.length - 1; target++) {
      const here = this.run.trueAt(target, time);
      if (!here) continue;
      const [x, y] = this.toPixels(...here);
      pen.lineWidth = 1.3;
      pen.beginPath();
      pen.moveTo(x - 5, y);
      pen.lineTo(x + 5, y);
      pen.moveTo(x, y - 5);
      pen.lineTo(x, y + 5);
      pen.stroke();
    }
  }

  drawOwn(state) {
    const pen = this.context, [x, y] = this.ownAt(state);
    pen.strokeStyle = this.colors.own;
    pen.lineWidth = 1;
    pen.globalAlpha = 0.5;
    pen.beginPath();
    for (let scan = Math.max(0, state.scan - state.trail); scan <= state.scan; scan++) {
      pen.lineTo(...this.toPixels(this.run.own[2 * scan], this.run.own[2 * scan + 1]));
    }
    pen.stroke();
    pen.globalAlpha = 1;
    pen.fillStyle = this.colors.own;
    pen.beginPath();
    pen.moveTo(x, y - 7);
    pen.lineTo(x + 6, y + 5);
    pen.lineTo(x - 6, y + 5);
    pen.closePath();
    pen.fill();
  }

  color(row, state) {
    return state.chosen === this.run.track[row] ? this.colors.chosen :
      this.colors[KINDS[this.run.kind[row]]];
  }

  // Lines of the last scans, dashed where a track coasted, open where it was not reported.
  drawTrails(rows, state) {
    const pen = this.context, styles = new Map();
    for (const row of rows) {
      const chosen = state.chosen === this.run.track[row];
      if (this.run.kind[row] === STATIC && !chosen) continue;
      this.addTrail(row, chosen ? 0 : state.scan - state.trail, state, styles);
    }
    for (const [, [path, color, chosen, coasting]] of styles) {
      pen.strokeStyle = color;
      pen.lineWidth = chosen ? 2 : this.radius < 4 ? 0.8 : 1.4;
      pen.globalAlpha = chosen ? 0.9 : 0.6;
      pen.setLineDash(coasting ? [4, 3] : []);
      pen.stroke(path);
    }
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  // Steps of a trail, added to the path of their style.
  addTrail(row, first, state, styles) {
    const run = this.run, color = this.color(row, state);
    let before = -1, path = null;
    for (const next of run.trail(run.track[row], first, state.scan)) {
      const coasting = run.status[next] === COASTING;
      if (before >= 0 && run.scanOf[next] - run.scanOf[before] <= 1) {
        const style = this.styleOf(styles, color, state.chosen === run.track[row], coasting);
        if (style !== path) style.moveTo(...this.pixelsOf(before));
        path = style;
        path.lineTo(...this.pixelsOf(next));
      } else path = null;
      before = next;
    }
  }

  styleOf(styles, color, chosen, coasting) {
    const key = `${color} ${coasting}`;
    if (!styles.has(key)) styles.set(key, [new Path2D(), color, chosen, coasting]);
    return styles.get(key)[0];
  }

  pixelsOf(row) {
    return this.toPixels(this.run.place[2 * row], this.run.place[2 * row + 1]);
  }

  // Of a tentative track the velocity is hardly known.
  hasVector(row) {
    return this.run.kind[row] !== STATIC && this.run.status[row] !== TENTATIVE;
  }

  // Where the line of a track's velocity ends that begins at its mark.
  vectorEnd(row, x, y) {
    const long = this.vector * this.scale;
    return [x + this.run.velocity[2 * row] * long, y - this.run.velocity[2 * row + 1] * long];
  }

  drawTrack(row, state) {
    const pen = this.context, run = this.run;
    const [x, y] = this.pixelsOf(row), [width, height] = this.size;
    if (!(x > -99 && y > -99 && x < width + 99 && y < height + 99)) return;
    const chosen = state.chosen === run.track[row];
    pen.strokeStyle = pen.fillStyle = this.color(row, state);
    pen.lineWidth = this.radius < 4 ? 1 : 1.6;
    if (this.radius < 2 && !chosen) {
      pen.fillRect(x - 1, y - 1, 2.5, 2.5);
      return;
    }
    if (this.hasVector(row)) {
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(...this.vectorEnd(row, x, y));
      pen.stroke();
    }
    const radius = this.radius * (run.status[row] === TENTATIVE ? 0.7 : 1);
    pen.beginPath();
    shapeOf(pen, run.kind[row], x, y, radius);
    if (run.status[row] !== COASTING && run.status[row] !== TENTATIVE) pen.fill();
    else {
      pen.fillStyle = this.colors.sea;
      pen.fill();
      pen.stroke();
    }
    if (chosen) {
      pen.beginPath();
      pen.arc(x, y, 10, 0, 2 * Math.PI);
      pen.stroke();
    }
  }

  // Identities beside the marks, where nothing else is; the chosen one and moving ones first.
  drawLabels(rows, state) {
    const pen = this.context, [width, height] = this.size, taken = new Taken(width, height);
    pen.font = `${LABEL}px system-ui, sans-serif`;
    pen.textAlign = "left";
    const rank = (row) => (this.run.track[row] === state.chosen ? 0 :
      this.run.kind[row] === MOVING ? 1 : this.run.kind[row] === STATIC ? 3 : 2);
    const inside = [], [ownX, ownY] = this.ownAt(state);
    taken.take([ownX - 6, ownY - 7, ownX + 6, ownY + 5]);
    for (const row of rows) {
      const [x, y] = this.pixelsOf(row);
      if (!(x > 0 && y > 0 && x < width && y < height)) continue;
      inside.push([rank(row), row, x, y]);
      this.takeMark(taken, row, x, y);
    }
    inside.sort((a, b) => a[0] - b[0]);
    let named = 0, tried = 0;
    for (const [order, row, x, y] of inside) {
      if (named >= NAMED || ++tried > 5 * NAMED) break;
      const text = this.run.ids[this.run.track[row]], wide = pen.measureText(text).width;
      const places = [[8, 4], [-8 - wide, 4], [-wide / 2, -9], [-wide / 2, 18]];
      const boxes = places.map(([a, b]) => [x + a, y + b - 10, x + a + wide, y + b + 1]);
      const box = boxes.find((each) => taken.isFree(each)) ?? (order ? null : boxes[0]);
      if (!box) continue;
      taken.take(box);
      named++;
      pen.fillStyle = this.color(row, state);
      this.writeOver(text, box[0], box[3] - 1);
    }
  }

  // A mark and the line of its velocity, which labels must not cover.
  takeMark(taken, row, x, y) {
    taken.take([x - 5, y - 5, x + 5, y + 5]);
    if (!this.hasVector(row)) return;
    const [u, v] = this.vectorEnd(row, x, y);
    const steps = Math.min(30, Math.ceil(Math.hypot(u - x, v - y) / CELL));
    for (let k = 1; k <= steps; k++) {
      const a = x + (u - x) * k / steps, b = y + (v - y) * k / steps;
      taken.take([a - 1, b - 1, a + 1, b + 1]);
    }
  }

  drawScale() {
    const pen = this.context, [, height] = this.size;
    const length = roundLength(120 / this.scale), wide = length * this.scale;
    pen.strokeStyle = pen.fillStyle = this.colors.ink;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.moveTo(14, height - 20);
    pen.lineTo(14, height - 14);
    pen.lineTo(14 + wide, height - 14);
    pen.lineTo(14 + wide, height - 20);
    pen.stroke();
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "left";
    const [across, up] = this.run.data.axes;
    this.writeOver(lengthText(Number(length.toPrecision(6))), 14, height - 25);
    this.writeOver(`\u2192 ${across}   \u2191 ${up}`, 14 + wide + 16, height - 14);
  }

  writeOver(text, x, y) {
    const pen = this.context;
    pen.lineWidth = 3;
    pen.lineJoin = "round";
    pen.strokeStyle = this.colors.sea;
    pen.strokeText(text, x, y);
    pen.fillText(text, x, y);
  }
}
