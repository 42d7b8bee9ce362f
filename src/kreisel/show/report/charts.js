"use strict";

const AXIS_COLOURS = ["major_label_text_color", "axis_label_text_color"];

let palette = {};

/** A colour of the page as it is now, light or dark. */
function colour(name) {
  palette[name] ??= getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  return palette[name];
}

/** One Bokeh plot, its legend, and its part of the cursor that runs over all of them. */
class Chart {
  constructor(element, view) {
    const { model } = view;
    Object.assign(this, { element, model, view, name: element.dataset.chart });
    this.traces = model.renderers.map((renderer) => ({ name: renderer.name, renderer, line: null }));
    this.entries = [...element.querySelectorAll("[data-entry]")].map((button) => this.entry(button));
    this.remark = element.querySelector(".remark");
    // The cursor is an element above the plot, moved by the compositor: redrawing nine plots would cost most frames.
    this.cursor = document.createElement("div");
    this.cursor.className = "cursor";
    element.querySelector(".plot").append(this.cursor);
  }

  entry(button) {
    const traces = this.traces.filter(({ renderer }) => renderer.tags[1] === button.dataset.entry);
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", shown);
      for (const { renderer } of traces) renderer.visible = shown;
    });
    return { output: button.querySelector("output"), trace: traces[0] };
  }

  /** Show the lines of these layers, a later one over an earlier one. */
  fill(layers, start) {
    for (const trace of this.traces) {
      const packed = layers.map((layer) => layer.lines[`${this.name}.${trace.name}`]).findLast(Boolean);
      trace.line = packed ? unpacked(packed, start) : { t: new Float64Array(0), y: new Float64Array(0) };
      trace.renderer.data_source.data = trace.line;
    }
    this.limits = layers.map((layer) => layer.limits[this.name]).findLast(Boolean) ?? [0, 1];
    this.span = this.limits[1] - this.limits[0];
    this.model.y_range.setv({ start: this.limits[0], end: this.limits[1] });
    if (this.model.left[0].axis_label.endsWith("[deg]")) {
      // Quarter turns, once there is more than half a turn to see.
      this.model.left[0].ticker.mantissas = this.span > 180 ? [9] : [1, 2, 5];
    }
    const beyond = layers.map((layer) => layer.beyond[this.name]).findLast(Boolean);
    this.remark.hidden = beyond === undefined;
    if (beyond) this.remark.textContent = `▲ up to ${number(beyond, beyond)}, beyond this chart`;
  }

  dress() {
    for (const axis of [...this.model.below, ...this.model.left]) {
      for (const name of AXIS_COLOURS) axis[name] = colour("faint");
    }
    for (const grid of this.model.center) grid.grid_line_color = colour("grid");
    for (const { renderer } of this.traces) {
      renderer.glyph.line_color = colour(renderer.tags[0]);
    }
  }

  /** Where the plot has its frame, in pixels of the element around it. */
  measure() {
    const { left, top, width, height } = this.view.frame.bbox;
    Object.assign(this, { left, width });
    Object.assign(this.cursor.style, { top: `${top}px`, height: `${height}px` });
  }

  point(time, range) {
    const share = (time - range.start) / (range.end - range.start);
    this.cursor.style.opacity = share >= 0 && share <= 1 ? 1 : 0;
    this.cursor.style.transform = `translateX(${(this.left + share * this.width).toFixed(1)}px)`;
  }

  timeAt(clientX, range) {
    const x = clientX - this.element.querySelector(".plot").getBoundingClientRect().left - this.left;
    return range.start + (x / this.width) * (range.end - range.start);
  }

  /** Numbers at the cursor: those of the samples nearest before it that are drawn. */
  read(time) {
    for (const { output, trace } of this.entries) {
      if (output && trace) output.textContent = number(valueAt(trace.line, time), this.span);
    }
  }
}

function unpacked({ t, y, y0 }, start) {
  return { t: Float64Array.from(floats(t), (x) => x + start), y: Float64Array.from(floats(y), (x) => x + y0) };
}

function valueAt({ t, y }, time) {
  if (!t.length) return NaN;
  let k = indexAt(t, time);
  if (k + 1 < t.length && t[k + 1] - time < time - t[k]) k += 1;
  return y[k];
}

/** `x` with as many digits as tell a thousandth of `span` from nothing, so that a number's width does not jump. */
function number(x, span) {
  if (!Number.isFinite(x)) return "–";
  const digits = Math.min(Math.max(3 - Math.floor(Math.log10(span || 1)), 0), 9);
  const text = x.toFixed(digits);
  // Round-off of either sign is nothing.
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}
