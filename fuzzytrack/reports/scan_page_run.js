// The run: columns of the page's data as typed arrays, and where the rows of a scan or a track are.

const KINDS = ["undecided", "moving", "static"];
const STATUSES = ["tentative", "confirmed", "coasting"];
const MOVING = 1, STATIC = 2, TENTATIVE = 0, COASTING = 2;

function decoded(text, Type) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k++) bytes[k] = letters.charCodeAt(k);
  return new Type(bytes.buffer);
}

class Run {
  constructor(data) {
    this.data = data;
    this.times = decoded(data.times, Float64Array);
    this.own = decoded(data.own, Float32Array);
    this.rowsFrom = decoded(data.reports.from, Uint32Array);
    this.track = decoded(data.reports.track, Uint32Array);
    this.place = decoded(data.reports.place, Float32Array);
    this.velocity = decoded(data.reports.velocity, Float32Array);
    this.deviation = decoded(data.reports.deviation, Float32Array);
    this.since = decoded(data.reports.since, Float32Array);
    this.status = decoded(data.reports.status, Uint8Array);
    this.kind = decoded(data.reports.kind, Uint8Array);
    this.existence = decoded(data.reports.existence, Uint8Array);
    this.plotsFrom = decoded(data.plots.from, Uint32Array);
    this.plots = decoded(data.plots.place, Float32Array);
    this.truthFrom = decoded(data.truth.from, Uint32Array);
    this.truthTime = decoded(data.truth.time, Float64Array);
    this.truth = decoded(data.truth.place, Float32Array);
    this.ids = data.reports.ids;
    this.scans = this.times.length;
    this.orderByTrack();
  }

  // Rows by track, in the order of their scans: those of track k begin at trackFrom[k].
  orderByTrack() {
    const count = this.ids.length, rows = this.track.length;
    this.trackFrom = new Uint32Array(count + 1);
    for (let row = 0; row < rows; row++) this.trackFrom[this.track[row] + 1]++;
    for (let k = 0; k < count; k++) this.trackFrom[k + 1] += this.trackFrom[k];
    const next = this.trackFrom.slice();
    this.byTrack = new Uint32Array(rows);
    this.scanOf = new Uint32Array(rows);
    for (let scan = 0; scan < this.scans; scan++) {
      for (let row = this.rowsFrom[scan]; row < this.rowsFrom[scan + 1]; row++) {
        this.scanOf[row] = scan;
        this.byTrack[next[this.track[row]]++] = row;
      }
    }
  }

  // Row of a track in a scan; -1 if it has none.
  rowOf(track, scan) {
    for (let row = this.rowsFrom[scan]; row < this.rowsFrom[scan + 1]; row++) {
      if (this.track[row] === track) return row;
    }
    return -1;
  }

  // Rows of a track up to a scan, and not before another.
  trail(track, first, last) {
    const from = this.trackFrom[track], to = this.trackFrom[track + 1];
    const rows = [];
    for (let k = this.after(track, first); k < to && k >= from; k++) {
      const row = this.byTrack[k];
      if (this.scanOf[row] > last) break;
      rows.push(row);
    }
    return rows;
  }

  // First place in byTrack of a track at which the scan is not before another.
  after(track, scan) {
    let low = this.trackFrom[track], high = this.trackFrom[track + 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.scanOf[this.byTrack[middle]] < scan) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  // Last scan that is not after a time.
  scanAt(time) {
    let low = 0, high = this.scans;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle + 1;
      else high = middle;
    }
    return Math.max(0, low - 1);
  }

  // Place of a true target at a time, or null.
  trueAt(target, time) {
    let low = this.truthFrom[target], high = this.truthFrom[target + 1];
    const end = high;
    if (low === high || time < this.truthTime[low] || time > this.truthTime[high - 1]) return null;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.truthTime[middle] <= time) low = middle + 1;
      else high = middle;
    }
    const a = low - 1, b = Math.min(low, end - 1);
    const span = this.truthTime[b] - this.truthTime[a];
    const part = span > 0 ? (time - this.truthTime[a]) / span : 0;
    return [0, 1].map((axis) =>
      this.truth[2 * a + axis] + part * (this.truth[2 * b + axis] - this.truth[2 * a + axis]));
  }

  speed(row) {
    return Math.hypot(this.velocity[2 * row], this.velocity[2 * row + 1]);
  }

  // Degrees clockwise from upwards.
  course(row) {
    const turn = Math.atan2(this.velocity[2 * row], this.velocity[2 * row + 1]);
    return (turn * 180 / Math.PI + 360) % 360;
  }

  // Corners of what is shown at first: without the farthest hundredth of the plots.
  extent() {
    const columns = [[], []];
    const add = (array, every) => {
      for (let k = 0; k + 1 < array.length; k += 2 * every) {
        columns[0].push(array[k]);
        columns[1].push(array[k + 1]);
      }
    };
    const tracked = this.place.length ? this.place : this.plots;
    add(tracked, 1 + (tracked.length >> 17));
    add(this.truth, 1 + (this.truth.length >> 15));
    add(this.own, 1 + (this.own.length >> 15));
    return columns.map((values) => {
      const known = values.filter(Number.isFinite).sort((a, b) => a - b);
      return known.length ? [known[0], known[known.length - 1]] : [-100, 100];
    });
  }
}
