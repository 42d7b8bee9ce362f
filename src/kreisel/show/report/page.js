"use strict";

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];
const READOUTS_A_SECOND = 12;

/** Time, choice and theme of the page; everything else shows what they are. */
class Page {
  constructor(data, charts, range) {
    Object.assign(this, { data, charts, range, playing: false, speed: 1, lastRead: 0 });
    this.time = data.start;
    this.scene = new Scene(find("#space"), data.space);
    this.whole = [range.start, range.end];
    this.prepareChoice();
    this.prepareBar();
    this.prepareScene();
    this.prepareCharts();
    this.prepareKeys();
    this.prepareTheme();
    this.choose();
  }

  // --- which IMU, which filter ---

  prepareChoice() {
    for (const select of [find("#imu"), find("#filter")]) {
      select.closest("label").hidden = select.options.length < 2;
      select.addEventListener("change", () => this.choose());
    }
    this.rows = [...document.querySelectorAll("#errors tbody tr")];
    this.rows.forEach((row, k) => row.addEventListener("click", () => this.chooseAnswer(k)));
  }

  chooseAnswer(k) {
    find("#imu").value = this.data.answers[k].imu;
    find("#filter").value = this.data.answers[k].filter;
    this.choose();
  }

  choose() {
    const { data, scene } = this;
    const imu = Math.max(find("#imu").selectedIndex, 0);
    const named = (answer) => answer.imu === find("#imu").value && answer.filter === find("#filter").value;
    const answer = data.answers.findIndex(named);
    const layers = [data.motion[0], data.readings[imu], data.answers[answer]].filter(Boolean);
    for (const chart of this.charts) chart.fill(layers, data.start);
    this.rows.forEach((row, k) => row.toggleAttribute("data-chosen", k === answer));
    Object.assign(scene, { imu, answer });
    scene.look();
    this.read();
  }

  // --- time ---

  prepareBar() {
    this.slider = find("#time");
    this.slider.addEventListener("input", () => this.seek(this.data.start + this.slider.value * this.span));
    find("#play").addEventListener("click", () => this.play(!this.playing));
    const select = find("#speed");
    for (const speed of SPEEDS) select.add(new Option(`${speed}×`, speed, speed === 1, speed === 1));
    select.addEventListener("change", () => (this.speed = Number(select.value)));
  }

  get span() {
    return this.data.end - this.data.start || 1;
  }

  play(playing) {
    if (playing && this.time >= this.data.end) this.seek(this.data.start);
    this.playing = playing;
    const button = find("#play");
    button.setAttribute("aria-label", playing ? "pause" : "play");
    button.toggleAttribute("data-playing", playing);
    if (playing) requestAnimationFrame((now) => this.frame(now, now));
  }

  frame(before, now) {
    if (!this.playing) return;
    // A page that was hidden for a while goes on from where it was.
    const time = this.time + this.speed * Math.min((now - before) / 1000, 0.25);
    if (time >= this.data.end) this.play(false);
    this.seek(time);
    if (this.playing) requestAnimationFrame((next) => this.frame(now, next));
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.data.start), this.data.end);
    this.slider.value = (this.time - this.data.start) / this.span;
    this.scene.draw(this.time - this.data.start);
    this.follow();
    for (const chart of this.charts) chart.point(this.time, this.range);
    const now = performance.now();
    if (this.playing && now - this.lastRead < 1000 / READOUTS_A_SECOND) return;
    this.lastRead = now;
    this.read();
  }

  /** Charts that show a part of the time turn over when the cursor leaves it. */
  follow() {
    const { start, end } = this.range;
    const width = end - start;
    if (!this.playing || width > 0.95 * (this.whole[1] - this.whole[0])) return;
    if (this.time >= start && this.time <= end) return;
    const first = Math.min(Math.max(this.time - 0.02 * width, this.whole[0]), this.whole[1] - width);
    this.range.setv({ start: first, end: first + width });
  }

  read() {
    for (const chart of this.charts) chart.read(this.time);
    const digits = this.span < 100 ? 2 : 1;
    find("#now").textContent = `${this.time.toFixed(digits)} s`;
    this.slider.setAttribute("aria-valuetext", `${this.time.toFixed(digits)} seconds`);
    for (const tile of document.querySelectorAll("[data-tile]")) {
      const value = this.tile(tile.dataset.tile);
      tile.hidden = value === null;
      if (value !== null) tile.querySelector("b").textContent = value;
    }
  }

  /** A number beside the body: the length of the three lines of a chart, or one line of it. */
  tile(name) {
    const [chart, trace] = name.split(".");
    const traces = this.charts.find((each) => each.name === chart)?.traces ?? [];
    const wanted = traces.filter((each) => (trace ? each.name === trace : each.name.length === 1));
    const values = wanted.filter(({ line }) => line.t.length).map(({ line }) => valueAt(line, this.time));
    if (!values.length) return null;
    const size = trace ? values[0] : Math.hypot(...values);
    return chart === "gyro" ? number((size * 180) / Math.PI, 100) : number(size, 10);
  }

  // --- the body in space ---

  prepareScene() {
    const { scene } = this;
    const buttons = [...document.querySelectorAll("[data-part]")];
    for (const button of buttons) {
      scene.shown[button.dataset.part] = true;
      button.addEventListener("click", () => {
        const shown = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", shown);
        scene.shown[button.dataset.part] = shown;
        scene.draw(scene.time);
      });
    }
    const { truth, answers, imus } = this.data.space;
    const missing = { estimate: !truth || !answers.length, imu: !imus.length, trails: !truth?.p };
    for (const button of buttons) button.hidden = missing[button.dataset.part] ?? false;
    if (!truth) find("[data-part=body]").lastChild.textContent = "body, as estimated";
    find("#reset").addEventListener("click", () => scene.reset());
    new ResizeObserver(() => scene.resize()).observe(scene.canvas);
    this.preparePointer(scene.canvas);
  }

  preparePointer(canvas) {
    const { scene } = this;
    const fingers = new Map();
    const apart = () => {
      const [a, b] = [...fingers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = fingers.get(event.pointerId);
      if (!last) return;
      const before = fingers.size > 1 ? apart() : 0;
      const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
      Object.assign(last, { x: event.clientX, y: event.clientY });
      if (fingers.size > 1) scene.zoom(apart() / before);
      else if (event.shiftKey || event.buttons === 2) scene.shift(dx, dy);
      else scene.turn(dx, dy);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => scene.reset());
    // The wheel belongs to the page until somebody has taken hold of the body.
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      scene.zoom(Math.exp(-0.0015 * event.deltaY));
    }, { passive: false });
  }

  // --- charts ---

  prepareCharts() {
    const point = () => this.charts.forEach((chart) => chart.point(this.time, this.range));
    this.range.change.connect(point);
    const measure = () => {
      for (const chart of this.charts) chart.measure();
      point();
    };
    for (const chart of this.charts) {
      chart.model.properties.inner_width.change.connect(measure);
      const plot = chart.element.querySelector(".plot");
      let down = [0, 0];
      plot.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]), true);
      plot.addEventListener("click", (event) => {
        // A drag is a zoom, and ends in a click as well.
        if (Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) {
          this.seek(chart.timeAt(event.clientX, this.range));
        }
      });
      plot.addEventListener("dblclick", () => this.showAll());
    }
    find("#whole").addEventListener("click", () => this.showAll());
    measure();
  }

  showAll() {
    this.range.setv({ start: this.whole[0], end: this.whole[1] });
    for (const { model, limits } of this.charts) model.y_range.setv({ start: limits[0], end: limits[1] });
  }

  // --- keys and theme ---

  prepareKeys() {
    document.addEventListener("keydown", (event) => {
      const { target, key } = event;
      // Whatever has keys of its own keeps them.
      if (event.ctrlKey || event.metaKey || event.altKey || target.matches("select, summary")) return;
      if (target.matches("button") && (key === " " || key === "Enter")) return;
      const act = this.keys(event)[key];
      if (!act) return;
      event.preventDefault();
      act();
    });
  }

  keys({ shiftKey, target }) {
    if (shiftKey && target === this.scene.canvas) {
      return {
        ArrowLeft: () => this.scene.turn(-15, 0),
        ArrowRight: () => this.scene.turn(15, 0),
        ArrowUp: () => this.scene.turn(0, 15),
        ArrowDown: () => this.scene.turn(0, -15),
      };
    }
    const step = this.span * (shiftKey ? 0.001 : 0.01);
    return {
      " ": () => this.play(!this.playing),
      ArrowLeft: () => this.seek(this.time - step),
      ArrowRight: () => this.seek(this.time + step),
      ArrowUp: () => this.faster(1),
      ArrowDown: () => this.faster(-1),
      Home: () => this.seek(this.data.start),
      End: () => this.seek(this.data.end),
      "+": () => this.scene.zoom(1.25),
      "-": () => this.scene.zoom(0.8),
    };
  }

  faster(steps) {
    const k = Math.min(Math.max(SPEEDS.indexOf(this.speed) + steps, 0), SPEEDS.length - 1);
    this.speed = SPEEDS[k];
    find("#speed").selectedIndex = k;
  }

  prepareTheme() {
    const system = matchMedia("(prefers-color-scheme: dark)");
    const wear = (dark) => {
      document.documentElement.dataset.theme = dark ? "dark" : "light";
      find("#theme").setAttribute("aria-pressed", dark);
      palette = {};
      for (const chart of this.charts) chart.dress();
      this.scene.look();
    };
    system.addEventListener("change", (event) => wear(event.matches));
    find("#theme").addEventListener("click", () => wear(document.documentElement.dataset.theme !== "dark"));
    wear(system.matches);
  }
}

function find(selector) {
  return document.querySelector(selector);
}

async function begin() {
  const data = JSON.parse(find("#data").textContent);
  const [views] = await Bokeh.embed.embed_items(data.documents, data.places);
  const plots = new Map([...views].map((view) => [view.model.name, view]));
  const charts = [...document.querySelectorAll("[data-chart]")].map(
    (element) => new Chart(element, plots.get(element.dataset.chart)),
  );
  window.kreisel = new Page(data, charts, charts[0].model.x_range);
  document.documentElement.dataset.ready = "";
}

begin();
