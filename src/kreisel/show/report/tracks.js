"use strict";

// Numbers come as base64 of single precision, lowest byte first.
function floats(text) {
  return new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

/** Last index of the increasing `t` whose time is not after `time`, at least 0. */
function indexAt(t, time) {
  let low = 0;
  let high = t.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
}

/** Places and attitudes of the body over time; times count from the start of the page. */
class Track {
  constructor(packed) {
    this.t = floats(packed.t);
    this.p = packed.p ? floats(packed.p) : null;
    this.q = packed.q ? floats(packed.q) : null;
  }

  place(time) {
    return this.p ? this.between(this.p, 3, time) : [0, 0, 0];
  }

  /** Rotation matrix, by rows, from body axes to N. */
  turn(time) {
    if (!this.q) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
    const [w, x, y, z] = unit(this.between(this.q, 4, time));
    return [
      1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ];
  }

  // A cubic through the samples on both sides: thirty poses a second then look like the curve they were taken from.
  between(values, size, time) {
    const { t } = this;
    const last = t.length - 1;
    const k = Math.min(indexAt(t, time), Math.max(last - 1, 0));
    const next = Math.min(k + 1, last);
    const step = t[next] - t[k] || 1;
    const u = Math.min(Math.max((time - t[k]) / step, 0), 1);
    const before = Math.max(k - 1, 0);
    const after = Math.min(next + 1, last);
    const [in0, in1] = [step / (t[next] - t[before] || 1), step / (t[after] - t[k] || 1)];
    const found = [];
    for (let c = 0; c < size; c++) {
      const [a, b] = [values[size * k + c], values[size * next + c]];
      const slope0 = in0 * (b - values[size * before + c]);
      const slope1 = in1 * (values[size * after + c] - a);
      const rise = b - a;
      found.push(a + u * (slope0 + u * (3 * rise - 2 * slope0 - slope1 + u * (slope0 + slope1 - 2 * rise))));
    }
    return found;
  }
}

function unit(v) {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length);
}

/** R v + p for a matrix by rows. */
function moved(R, v, p = [0, 0, 0]) {
  return [0, 1, 2].map((k) => R[3 * k] * v[0] + R[3 * k + 1] * v[1] + R[3 * k + 2] * v[2] + p[k]);
}
