"use strict";
// What has come of the last minute, in the host's columns, and its merge into as many columns as there are pixels. The least and the
// largest of a quantity survive every merge, so that what lasted one tick is still drawn.
class History {
  constructor(columnSeconds, keptSeconds) {
    this.columnSeconds = columnSeconds;
    this.most = Math.ceil(keptSeconds / columnSeconds);
    this.columns = [];
    this.points = [];
  }

  push(columns, points) {
    for (const column of columns) this.columns.push(column);
    for (const ofColumn of points) this.points.push(ofColumn);
    // Seldom, since it moves all that is left.
    if (this.columns.length > 1.25 * this.most) {
      this.columns.splice(0, this.columns.length - this.most);
      this.points.splice(0, this.points.length - this.most);
    }
  }

  // When the first and the last column began, s.
  get first() {
    return this.columns.length ? this.columns[0][0] : 0;
  }

  get last() {
    return this.columns.length ? this.columns[this.columns.length - 1][0] : 0;
  }

  // Index of the first column from a time on.
  from(seconds) {
    let [low, high] = [0, this.columns.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.columns[middle][0] < seconds) low = middle + 1; else high = middle;
    }
    return low;
  }

  // Quantities over time from `seconds` on, in no more than so many columns; a column of nulls stands where ticks are missing.
  merged(seconds, pixels) {
    const first = this.from(seconds);
    const group = this.columnSeconds * Math.max(1, Math.ceil((this.columns.length - first) / Math.max(1, pixels)));
    const merged = { seconds: [], voltage: [[], []], displacement: [[], []], interval: [[], []], sensor: [[], []], error: [[], []], halfWidth: [] };
    const pairs = [merged.voltage, merged.displacement, merged.interval, merged.sensor, merged.error];
    const extend = ([least, largest], value) => {
      const at = least.length - 1;
      if (value === null) return;
      if (least[at] === null || value[0] < least[at]) least[at] = value[0];
      if (largest[at] === null || value[1] > largest[at]) largest[at] = value[1];
    };
    const begin = (time) => {
      merged.seconds.push(time);
      for (const pair of pairs) for (const end of pair) end.push(null);
      merged.halfWidth.push(null);
    };
    let current = null;
    for (let index = first; index < this.columns.length; index++) {
      const [time, gap, voltage, displacement, halfWidth, sensor, error] = this.columns[index];
      // Groups stay what they are while time goes on; a column's beginning is a multiple of its length, but for rounding.
      const own = Math.floor((time + 0.5 * this.columnSeconds) / group);
      // Between the two, since the plot needs times that increase; after a gap a column begins anywhere.
      if (gap && current !== null) begin((merged.seconds[merged.seconds.length - 1] + time) / 2);
      if (own !== current || gap) begin(time);
      current = own;
      extend(merged.voltage, voltage);
      extend(merged.displacement, displacement);
      extend(merged.sensor, sensor);
      extend(merged.error, error);
      if (halfWidth !== null) {
        extend(merged.interval, [displacement[0] - halfWidth, displacement[1] + halfWidth]);
        const at = merged.halfWidth.length - 1;
        merged.halfWidth[at] = Math.max(merged.halfWidth[at] ?? 0, halfWidth);
      }
    }
    return merged;
  }

  // The loop's points from `seconds` on: V, µm, V, µm …, in pieces without a gap.
  pieces(seconds) {
    const pieces = [];
    for (let index = this.from(seconds); index < this.columns.length; index++) {
      if (this.columns[index][1] || !pieces.length) pieces.push([]);
      const piece = pieces[pieces.length - 1];
      for (const value of this.points[index]) piece.push(value);
    }
    return pieces;
  }
}
