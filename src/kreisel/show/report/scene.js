"use strict";

const FIRST_VIEW = { azimuth: -58, elevation: 24, zoom: 1, target: [0, 0, 0] };
const TRAIL_PIECES = 16;
const POINTS_A_PIECE = 8;

/** The body on its path, drawn on a canvas. What stands still is drawn again only when the eye has moved. */
class Scene {
  constructor(canvas, space) {
    Object.assign(this, { canvas, space, view: { ...FIRST_VIEW }, shown: {}, answer: null, imu: 0, time: 0 });
    this.pen = canvas.getContext("2d");
    this.still = document.createElement("canvas");
    this.truth = space.truth ? new Track(space.truth) : null;
    this.answers = space.answers.map((packed) => new Track(packed));
    this.travelled = this.truth?.p ? distances(this.truth.p) : null;
    this.reach = Math.hypot(...space.half);
  }

  // --- the eye ---

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.ratio = Math.min(window.devicePixelRatio || 1, 2);
    Object.assign(this, { width, height });
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.round(width * this.ratio);
      canvas.height = Math.round(height * this.ratio);
    }
    this.look();
  }

  /** Take up the view as it is now, and draw. */
  look() {
    if (!this.width) return;
    const { azimuth, elevation, zoom, target } = this.view;
    const [a, e] = [azimuth, elevation].map((angle) => (angle * Math.PI) / 180);
    const [ca, sa, ce, se] = [Math.cos(a), Math.sin(a), Math.cos(e), Math.sin(e)];
    this.right = [-sa, ca, 0];
    this.upwards = [-se * ca, -se * sa, ce];
    this.towards = [ce * ca, ce * sa, se];
    this.distance = 4.5 * this.reach;
    this.focal = zoom * this.fit();
    this.middle = [0.5 * this.width, 0.5 * this.height];
    this.target = target;
    this.drawStill();
    this.draw(this.time);
  }

  // The focal length in pixels at which the box fills the canvas, however it is turned about the vertical.
  fit() {
    const [x, y, z] = this.space.half;
    const across = Math.hypot(x, y);
    const tilt = (Math.abs(this.view.elevation) * Math.PI) / 180;
    const tall = z * Math.cos(tilt) + across * Math.sin(tilt);
    return 0.9 * this.distance * Math.min((0.47 * this.width) / across, (0.45 * this.height) / tall);
  }

  /** Pixel of a point in N about the centre of the box. */
  seen([x, y, z]) {
    const d = [x - this.target[0], y - this.target[1], z - this.target[2]];
    const scale = this.focal / Math.max(this.distance - dot(this.towards, d), 0.05 * this.distance);
    return [this.middle[0] + scale * dot(this.right, d), this.middle[1] - scale * dot(this.upwards, d)];
  }

  turn(dx, dy) {
    const { view } = this;
    view.azimuth -= 0.4 * dx;
    view.elevation = Math.min(Math.max(view.elevation + 0.4 * dy, -89), 89);
    this.look();
  }

  shift(dx, dy) {
    const scale = this.distance / this.focal;
    const move = (k) => scale * (dy * this.upwards[k] - dx * this.right[k]);
    this.view.target = this.view.target.map((x, k) => x + move(k));
    this.look();
  }

  zoom(factor) {
    this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 0.3), 60);
    this.look();
  }

  reset() {
    this.view = { ...FIRST_VIEW };
    this.look();
  }

  // --- what stands still ---

  drawStill() {
    const pen = this.still.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    pen.lineJoin = "round";
    this.drawFloor(pen);
    this.drawAxes(pen);
    if (!this.truth?.p) return;
    const { p } = this.truth;
    const floor = -this.space.half[2];
    this.stroke(pen, p, colour("shadow"), 1.2, (k) => [p[k], p[k + 1], floor]);
    this.stroke(pen, p, colour("path"), 1, (k) => [p[k], p[k + 1], p[k + 2]], 0.55);
  }

  // Of a long path what has been drawn already is not drawn again: ten minutes can be hundreds of laps of one loop.
  stroke(pen, p, style, width, point, alpha = 1) {
    const across = Math.ceil(this.width / 2);
    const long = p.length > 3 * 5000;
    const taken = new Int32Array(across * Math.ceil(this.height / 2));
    let drawn = 9;
    pen.beginPath();
    let [x, y] = this.seen(point(0));
    let joined = false;
    for (let k = 3; k < p.length; k += 3) {
      const [u, v] = this.seen(point(k));
      const steps = Math.ceil(Math.max(Math.abs(u - x), Math.abs(v - y)) / 2);
      // Less than a pixel waits for the next point.
      if (!steps || (steps === 1 && Math.abs(u - x) + Math.abs(v - y) < 1)) continue;
      // Seen from very near, pieces are longer than the canvas, and few.
      let fresh = !long || steps > across;
      drawn += 1;
      for (let n = 0; n <= steps && long && steps <= across; n++) {
        const column = (x + ((u - x) * n) / steps) >> 1;
        if (column < 0 || column >= across) continue;
        const cell = ((y + ((v - y) * n) / steps) >> 1) * across + column;
        // The pieces just before share their cells with this one.
        fresh ||= !taken[cell] || drawn - taken[cell] < 9;
        taken[cell] ||= drawn;
      }
      if (fresh && !joined) pen.moveTo(x, y);
      if (fresh) pen.lineTo(u, v);
      joined = fresh;
      [x, y] = [u, v];
    }
    pen.globalAlpha = alpha;
    pen.strokeStyle = style;
    pen.lineWidth = width;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawFloor(pen) {
    const [hx, hy, hz] = this.space.half;
    const { centre } = this.space;
    const step = niceStep((2 * Math.max(hx, hy)) / 5);
    // Numbers stand at the edges nearest to the eye.
    const [nearX, nearY] = [this.towards[0] > 0 ? hx : -hx, this.towards[1] > 0 ? hy : -hy];
    pen.lineWidth = 1;
    pen.strokeStyle = colour("grid");
    pen.fillStyle = colour("faint");
    const rim = [[-hx, -hy], [hx, -hy], [hx, hy], [-hx, hy], [-hx, -hy]].map(([x, y]) => this.seen([x, y, -hz]));
    rim.slice(1).forEach((corner, k) => line(pen, rim[k], corner));
    for (const x of ticks(centre[0] - hx, centre[0] + hx, step)) {
      const u = x - centre[0];
      line(pen, this.seen([u, -hy, -hz]), this.seen([u, hy, -hz]));
      if (!this.space.still) this.beyond(pen, tidy(x, step), [u, 0, -hz], [u, nearY, -hz], 11);
    }
    for (const y of ticks(centre[1] - hy, centre[1] + hy, step)) {
      const v = y - centre[1];
      line(pen, this.seen([-hx, v, -hz]), this.seen([hx, v, -hz]));
      if (!this.space.still) this.beyond(pen, tidy(y, step), [0, v, -hz], [nearX, v, -hz], 11);
    }
    if (this.space.still) return;
    this.beyond(pen, "east [m]", [0, 0, -hz], [0, nearY, -hz], 42);
    this.beyond(pen, "north [m]", [0, 0, -hz], [nearX, 0, -hz], 42);
    this.drawHeights(pen);
  }

  // A pole with heights at that upright edge of the box which is seen furthest to the left.
  drawHeights(pen) {
    const [hx, hy, hz] = this.space.half;
    const step = niceStep((2 * hz) / 6);
    const [x, y] = this.leftmost(1.06);
    line(pen, this.seen([x, y, -hz]), this.seen([x, y, hz]));
    const up = this.space.centre[2];
    for (const z of ticks(up - hz, up + hz, step)) {
      const [u, v] = this.seen([x, y, z - up]);
      line(pen, [u - 4, v], [u, v]);
      // On a narrow screen there is no room to the left.
      if (u < 40) text(pen, tidy(z, step), u + 5, v, "left");
      else text(pen, tidy(z, step), u - 8, v, "right");
    }
    const [u, v] = this.seen([x, y, hz]);
    text(pen, "up [m]", Math.max(u, 24), v - 12, "center");
  }

  leftmost(scale) {
    const [hx, hy] = this.space.half.map((half) => scale * half);
    const edges = [[-hx, -hy], [-hx, hy], [hx, -hy], [hx, hy]];
    return edges.reduce((a, b) => (this.seen([...a, 0])[0] < this.seen([...b, 0])[0] ? a : b));
  }

  // East, north and up from the far corner of the floor, and which way gravity pulls.
  drawAxes(pen) {
    const [hx, hy, hz] = this.space.half;
    const far = [this.towards[0] > 0 ? -hx : hx, this.towards[1] > 0 ? -hy : hy];
    // A body that has no path stands in the middle, and hides the far corner.
    const corner = [...(this.space.still ? this.leftmost(1) : far), -hz];
    const long = 0.5 * Math.min(hx, hy, hz * 2);
    pen.lineWidth = 2;
    [["E", "x"], ["N", "y"], ["U", "z"]].forEach(([name, style], k) => {
      const tip = corner.map((c, axis) => c + (axis === k ? long : 0));
      pen.strokeStyle = pen.fillStyle = colour(style);
      arrow(pen, this.seen(corner), this.seen(tip));
      this.label(pen, name, corner.map((c, axis) => c + (axis === k ? 1.18 * long : 0)), true);
    });
    const above = [corner[0], corner[1], hz];
    pen.strokeStyle = pen.fillStyle = colour("faint");
    arrow(pen, this.seen(above), this.seen([corner[0], corner[1], hz - 0.7 * long]));
    this.label(pen, "g", [corner[0], corner[1], hz + 0.14 * long], true);
  }

  /** Words that begin so many pixels beyond the rim of the floor, on the way out from a point inside. */
  beyond(pen, words, inside, rim, pixels) {
    const [[x, y], [u, v]] = [this.seen(inside), this.seen(rim)];
    const length = Math.hypot(u - x, v - y) || 1;
    const [right, down] = [(u - x) / length, (v - y) / length];
    const align = right > 0.4 ? "left" : right < -0.4 ? "right" : "center";
    // On a narrow screen the name of an axis would stick out.
    const room = align === "left" ? pen.measureText(words).width : 0;
    text(pen, words, Math.min(u + pixels * right, this.width - room - 6), v + pixels * down, align);
  }

  label(pen, words, point, bold = false) {
    const [x, y] = this.seen(point);
    text(pen, words, x, y, "center", bold);
  }

  // --- what moves ---

  /** Draw the body where it is at `time`, in seconds after the start. */
  draw(time) {
    this.time = time;
    const { pen, ratio, truth } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.drawImage(this.still, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.lineJoin = pen.lineCap = "round";
    const answer = this.answers[this.answer];
    const body = truth ?? answer;
    if (!body) return;
    const p = body.place(time);
    const R = body.turn(time);
    if (this.shown.trails && this.travelled) this.drawTrails(time, answer);
    if (this.shown.body) this.drawBody(p, R);
    if (this.shown.estimate && truth && answer) this.drawGhost(p, answer.turn(time));
    this.drawPoints(p, R);
  }

  drawBody(p, R) {
    const { pen } = this;
    const corners = this.corners(p, R);
    const floor = -this.space.half[2];
    if (!this.space.still) {
      this.polygon(this.space.faces[0].map((k) => this.seen([corners[k][0], corners[k][1], floor])));
      pen.fillStyle = colour("shadow");
      pen.fill();
      pen.strokeStyle = colour("edge");
      pen.lineWidth = 1;
      pen.setLineDash([3, 4]);
      line(pen, this.seen(p), this.seen([p[0], p[1], floor]));
      pen.setLineDash([]);
    }
    pen.lineWidth = 0.7;
    pen.strokeStyle = colour("body-edge");
    this.facing(corners).forEach(([face, outline]) => {
      this.polygon(outline);
      pen.fillStyle = colour(`face-${face}`);
      pen.fill();
      pen.stroke();
    });
  }

  // The body as the filter has it: glass, a little larger, so that it shows around the true one.
  drawGhost(p, R) {
    const { pen } = this;
    pen.strokeStyle = pen.fillStyle = colour("estimate");
    pen.lineWidth = 1.6;
    this.facing(this.corners(p, R, 1.12)).forEach(([, outline]) => {
      this.polygon(outline);
      pen.globalAlpha = 0.16;
      pen.fill();
      pen.globalAlpha = 1;
      pen.stroke();
    });
  }

  drawPoints(p, R) {
    const { pen } = this;
    pen.lineWidth = 1;
    pen.strokeStyle = colour("ink");
    if (this.shown.body) this.dot(p, 4.5, colour("mass"));
    if (!this.shown.imu) return;
    this.space.imus.forEach((imu, k) => {
      const at = moved(R, imu.p, p);
      if (k === this.imu) this.drawSensor(at, R, imu.R.flat());
      pen.strokeStyle = colour("ink");
      pen.lineWidth = 1;
      this.dot(at, k === this.imu ? 5 : 3.5, colour(imu.colour));
    });
  }

  // The axes of the sensor whose readings are charted, in the colours of the charts.
  drawSensor(at, R, R_BS) {
    const long = 0.42 * this.space.length;
    this.pen.lineWidth = 1.8;
    ["x", "y", "z"].forEach((axis, k) => {
      const along = moved(R, [R_BS[k], R_BS[3 + k], R_BS[6 + k]]);
      this.pen.strokeStyle = this.pen.fillStyle = colour(axis);
      arrow(this.pen, this.seen(at), this.seen(at.map((x, c) => x + long * along[c])), 5);
    });
  }

  // Behind the body its path, and behind the IMU what it went through, in truth and by the estimate.
  drawTrails(time, answer) {
    const imu = this.space.imus[this.imu];
    const times = this.trailTimes(time);
    const places = times.map((t) => this.truth.place(t));
    this.fade(places, colour("accent"), 3);
    if (!imu || !this.shown.imu || Math.hypot(...imu.p) < 1e-3 * this.reach) return;
    const trail = (track) => places.map((p, k) => moved(track.turn(times[k]), imu.p, p));
    this.fade(trail(this.truth), colour(imu.colour), 1.6);
    if (this.shown.estimate && answer) this.fade(trail(answer), colour("estimate"), 1.2);
  }

  trailTimes(time) {
    const { t } = this.truth;
    const { travelled } = this;
    const here = indexAt(t, time);
    const length = Math.min(travelled[here], 2.4 * Math.max(...this.space.half));
    const count = TRAIL_PIECES * POINTS_A_PIECE;
    const times = [];
    for (let k = 0; k < count; k++) {
      const wanted = travelled[here] - length * (1 - k / count);
      const row = Math.min(indexAt(travelled, wanted), here);
      const step = travelled[row + 1] - travelled[row] || Infinity;
      times.push(Math.min(t[row] + ((wanted - travelled[row]) / step) * (t[row + 1] - t[row] || 0), time));
    }
    return [...times, time];
  }

  fade(points, style, width) {
    const { pen } = this;
    const seen = points.map((point) => this.seen(point));
    pen.strokeStyle = style;
    for (let k = 0; k < TRAIL_PIECES; k++) {
      const share = (k + 1) / TRAIL_PIECES;
      pen.globalAlpha = share ** 1.5;
      pen.lineWidth = width * (0.4 + 0.6 * share);
      this.polyline(seen.slice(k * POINTS_A_PIECE, (k + 1) * POINTS_A_PIECE + 1));
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }

  // --- small parts ---

  corners(p, R, scale = 1) {
    return this.space.corners.map((corner) => moved(R, corner.map((x) => x * scale * this.space.length), p));
  }

  /** Faces turned towards the eye, with their outlines in pixels. */
  facing(corners) {
    const seen = corners.map((corner) => this.seen(corner));
    const outlines = this.space.faces.map((face, k) => [k, face.map((corner) => seen[corner])]);
    // Counter-clockwise from outside; pixels count downwards, which turns the sign.
    return outlines.filter(([, outline]) => area(outline) < 0);
  }

  polyline(points) {
    this.pen.beginPath();
    points.forEach(([x, y], k) => (k ? this.pen.lineTo(x, y) : this.pen.moveTo(x, y)));
  }

  polygon(points) {
    this.polyline(points);
    this.pen.closePath();
  }

  dot(point, radius, fill) {
    const [x, y] = this.seen(point);
    this.pen.beginPath();
    this.pen.arc(x, y, radius, 0, 2 * Math.PI);
    this.pen.fillStyle = fill;
    this.pen.fill();
    this.pen.stroke();
  }
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function area(points) {
  return points.reduce((sum, [x, y], k) => {
    const [u, v] = points[(k + 1) % points.length];
    return sum + 0.5 * (x * v - u * y);
  }, 0);
}

/** Length of the path up to each of its points. */
function distances(p) {
  const found = new Float64Array(p.length / 3);
  for (let k = 1; k < found.length; k++) {
    const d = Math.hypot(p[3 * k] - p[3 * k - 3], p[3 * k + 1] - p[3 * k - 2], p[3 * k + 2] - p[3 * k - 1]);
    found[k] = found[k - 1] + d;
  }
  return found;
}

function line(pen, [x0, y0], [x1, y1]) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

function arrow(pen, from, to, head = 8) {
  line(pen, from, to);
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
  pen.beginPath();
  pen.moveTo(...to);
  for (const side of [2.7, -2.7]) {
    pen.lineTo(to[0] + head * Math.cos(angle + side), to[1] + head * Math.sin(angle + side));
  }
  pen.closePath();
  pen.fill();
}

function text(pen, words, x, y, align, bold = false) {
  pen.font = `${bold ? "600 13px" : "11.5px"} system-ui, sans-serif`;
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.fillText(words, x, y);
}

/** 1, 2 or 5 times a power of ten, not below `least`. */
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((k) => k * power >= least);
}

function ticks(low, high, step) {
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(k * step);
  return found;
}

function tidy(value, step) {
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}
