// The figures that move: drawn by Bokeh from the numbers in the page, each when it is first seen.
const tpcFigures = (() => {
  "use strict";
  const MOST = 2400; // points of a line: a few for each column of pixels
  const DOTS = 160; // single evaluations are dots while there are no more of them
  const HALF_BOX = 0.1; // of a summary's results, above and below
  const LARGEST = 1e150; // what Bokeh can still subtract
  const MARK_DASH = { I: [], II: [6, 3], "": [2, 2] };
  const painted = [];
  const missions = new Map();

  const colour = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

  // Remembers which property of a model has which of the page's colours.
  const paint = (model, properties) => {
    painted.push([model, properties]);
    for (const [property, name] of Object.entries(properties)) model[property] = colour(name);
    return model;
  };
  const repaint = () => {
    for (const [model, properties] of painted) {
      for (const [property, name] of Object.entries(properties)) model[property] = colour(name);
    }
  };

  const unpacked = (text, Kind) => {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    return new Kind(bytes.buffer);
  };

  const longer = (values, last) => {
    const all = new Float64Array(values.length + 1);
    all.set(values);
    all[values.length] = last;
    return all;
  };

  const missionOf = (ident) => {
    if (!missions.has(ident)) {
      missions.set(ident, JSON.parse(document.getElementById(`${ident}-numbers`).textContent));
    }
    return missions.get(ident);
  };

  const seriesOf = (mission, number) => {
    const kept = mission.series[number];
    if (typeof kept.t === "string") {
      kept.t = unpacked(kept.t, Float32Array);
      kept.c = unpacked(kept.c, Float64Array);
      kept.r = unpacked(kept.r, Uint8Array);
      // A parameter keeps its value up to the end.
      const values = unpacked(kept.lv, Float64Array);
      kept.lt = longer(unpacked(kept.lt, Float64Array), mission.seconds);
      kept.lv = longer(values, values.length ? values[values.length - 1] : NaN);
      for (const name of ["kept", "results"]) {
        kept[name] = kept[name].map((column) => Array.from(unpacked(column, Float64Array)));
      }
    }
    return kept;
  };

  // The first place in ascending times that is not before `time`.
  const place = (times, time) => {
    let low = 0;
    let high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  };

  // The points between two times, and one beyond each end; of too many, the first, lowest, highest
  // and last of each of equal spans, so that no extreme is lost. A pause longer than `gap` is a NaN.
  const between = (times, values, from, to, gap) => {
    const first = Math.max(0, place(times, from) - 1);
    const end = Math.min(times.length, place(times, to) + 1);
    const out = { x: [], y: [], first, end };
    let last = -1;
    const put = (i) => {
      if (i === last) return;
      if (last >= 0 && times[i] - times[last] > gap) {
        out.x.push(NaN);
        out.y.push(NaN);
      }
      out.x.push(times[i]);
      const value = values[i];
      out.y.push(Number.isFinite(value) ? Math.max(-LARGEST, Math.min(LARGEST, value)) : NaN);
      last = i;
    };
    if (end - first <= MOST) {
      for (let i = first; i < end; i++) put(i);
      return out;
    }
    const width = ((times[end - 1] - times[first]) / MOST) * 4;
    for (let i = first; i < end; ) {
      const until = times[i] + width;
      let low = i;
      let high = i;
      let j = i;
      do {
        if (!(values[j] >= values[low])) low = j;
        if (!(values[j] <= values[high])) high = j;
        j++;
      } while (j < end && times[j] <= until);
      put(i);
      put(Math.min(low, high));
      put(Math.max(low, high));
      put(j - 1);
      i = j;
    }
    return out;
  };

  const figureOf = (options) => {
    const figure = Bokeh.Plotting.figure({
      tools: [],
      toolbar_location: null,
      sizing_mode: "stretch_width",
      output_backend: "canvas",
      background_fill_color: null,
      border_fill_color: null,
      min_border: 4,
      lod_threshold: null,
      ...options,
    });
    figure.outline_line_color = null;
    const plain = { major_label_text_color: "faint", axis_label_text_color: "faint" };
    for (const axis of [...figure.below, ...figure.left]) {
      axis.minor_tick_line_color = null;
      axis.major_tick_in = 0;
      axis.major_tick_out = 4;
      axis.major_label_text_font = axis.axis_label_text_font = colour("sans");
      axis.major_label_text_font_size = axis.axis_label_text_font_size = "12px";
      axis.axis_label_text_font_style = "normal";
      axis.axis_line_color = axis.major_tick_line_color = null;
      paint(axis, plain);
    }
    for (const axis of figure.below) paint(axis, { axis_line_color: "edge", major_tick_line_color: "edge" });
    const [across, along] = figure.center;
    across.grid_line_color = null;
    paint(along, { grid_line_color: "grid" });
    const pan = new Bokeh.PanTool({ dimensions: "width" });
    const wheel = new Bokeh.WheelZoomTool({ dimensions: "width", modifiers: { ctrl: true } });
    figure.add_tools(pan, wheel);
    figure.toolbar.active_drag = pan;
    figure.toolbar.active_scroll = wheel;
    return figure;
  };
  const withoutTimes = (figure) => {
    for (const axis of figure.below) axis.visible = false;
    return figure;
  };

  const verticals = (figure, marks, width) => {
    for (const mark of marks) {
      figure.add_layout(
        paint(
          new Bokeh.Span({
            location: mark.t, dimension: "height", line_width: width, line_dash: MARK_DASH[mark.type],
          }),
          { line_color: "ink" },
        ),
      );
    }
  };

  // Everything that moves the shared range: buttons, keys, double click, and what follows from it.
  const steer = (host, figures, range, whole, home, moved) => {
    const show = (from, to) => {
      const most = whole[1] - whole[0];
      const length = Math.min(most, Math.max(to - from, most * 1e-6));
      const start = Math.min(Math.max(from, whole[0]), whole[1] - length);
      range.setv({ start, end: start + length });
    };
    const zoom = (factor) => {
      const middle = (range.start + range.end) / 2;
      const half = ((range.end - range.start) / 2) * factor;
      show(middle - half, middle + half);
    };
    const pan = (part) => {
      const by = (range.end - range.start) * part;
      show(range.start + by, range.end + by);
    };
    const actions = {
      "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), 0: () => show(...home),
      ArrowLeft: () => pan(-0.2), ArrowRight: () => pan(0.2),
    };
    const controls = document.createElement("span");
    controls.className = "controls";
    for (const [label, name, key] of [
      ["+", "Zoom in", "+"], ["−", "Zoom out", "-"], ["⟲", "Back to the beginning", "0"],
    ]) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = label;
      button.title = name;
      button.setAttribute("aria-label", name);
      button.addEventListener("click", actions[key]);
      controls.append(button);
    }
    host.append(controls);
    host.tabIndex = 0;
    host.setAttribute("role", "group");
    host.addEventListener("keydown", (event) => {
      const action = event.ctrlKey || event.metaKey || event.altKey ? undefined : actions[event.key];
      if (action === undefined || event.target !== host) return;
      action();
      event.preventDefault();
    });
    for (const figure of figures) figure.on_event("doubletap", () => show(...home));
    let waiting = false;
    range.change.connect(() => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        moved();
      });
    });
    host.tpcRange = range;
  };

  // A line under the pointer in all figures of a group, and a sentence about what is there.
  const readout = (host, figures, say) => {
    const line = document.createElement("p");
    line.className = "readout number";
    line.textContent = "\u00a0";
    host.append(line);
    const spans = figures.map((figure) => {
      const span = new Bokeh.Span({ location: 0, visible: false, dimension: "height", line_width: 1 });
      figure.add_layout(paint(span, { line_color: "faint" }));
      return span;
    });
    const move = (x) => {
      for (const span of spans) span.setv(x === null ? { visible: false } : { visible: true, location: x });
      line.textContent = (x === null ? "" : say(x)) || "\u00a0";
    };
    for (const figure of figures) {
      figure.on_event("mousemove", (event) => move(event.x));
      figure.on_event("mouseleave", () => move(null));
    }
  };

  const number = (value) =>
    Number.isFinite(value) ? String(Number(value.toPrecision(6))) : String(value);

  const evidence = (host) => {
    const mission = missionOf(host.dataset.mission);
    const card = mission.cards[host.dataset.card];
    const series = seriesOf(mission, card.series);
    const margin = (card.end - card.begin || 1) * 0.01;
    const home = [card.begin - margin, card.end + margin];
    const whole = [Math.min(0, home[0]), Math.max(mission.seconds, home[1])];
    const range = new Bokeh.Range1d({ start: home[0], end: home[1], bounds: whole });
    const scale = new Bokeh.Range1d({ start: card.low, end: card.high });
    const common = { x_range: range, min_border_left: 64, min_border_right: 12 };
    const upper = withoutTimes(figureOf({ ...common, height: 230, y_range: scale, y_axis_label: card.label }));
    const lower = figureOf({
      ...common, height: 84, y_range: new Bokeh.Range1d({ start: -0.35, end: 1.35 }),
      x_axis_label: "seconds since the recording began",
    });
    lower.left[0].ticker = new Bokeh.FixedTicker({ ticks: [0, 1] });
    lower.left[0].major_label_overrides = new Map([[0, "false"], [1, "true"]]);
    lower.center[1].visible = false;
    if (card.window !== null) {
      for (const figure of [upper, lower]) {
        figure.add_layout(paint(
          new Bokeh.BoxAnnotation({
            left: card.window, right: card.mark, level: "underlay", line_color: null, fill_alpha: 1,
          }),
          { fill_color: "span" },
        ));
      }
    }
    for (const [low, high] of card.feasible) {
      upper.add_layout(paint(
        new Bokeh.BoxAnnotation({
          // Without an end it reaches as far as the figure.
          ...(low === null ? {} : { bottom: low }), ...(high === null ? {} : { top: high }),
          level: "underlay", line_color: null, fill_color: null,
          hatch_pattern: "right_diagonal_line", hatch_scale: 14, hatch_weight: 0.8,
        }),
        { hatch_color: "would" },
      ));
    }
    const size = card.high - card.low;
    const value = card.culprit ? "culprit" : "value";
    const sources = {
      line: new Bokeh.ColumnDataSource({ data: { x: [], y: [] } }),
      limit: new Bokeh.ColumnDataSource({ data: { x: [], y: [] } }),
      result: new Bokeh.ColumnDataSource({ data: { x: [], y: [] } }),
      yes: new Bokeh.ColumnDataSource({ data: { x: [], y: [] } }),
      no: new Bokeh.ColumnDataSource({ data: { x: [], y: [] } }),
    };
    const at = { x: { field: "x" }, y: { field: "y" } };
    const draw = (figure, glyph, source, properties) => {
      const renderer = figure.add_glyph(glyph, source);
      renderer.nonselection_glyph = null;
      paint(renderer.glyph, properties);
    };
    // Of what is only in summaries the outermost values are known, and which results there were.
    const boxes = (figure, left, right, bottom, top) => {
      const glyph = new Bokeh.Quad({
        left: { field: "left" }, right: { field: "right" }, bottom: { field: "bottom" }, top: { field: "top" },
        fill_alpha: 0.3,
      });
      draw(figure, glyph, new Bokeh.ColumnDataSource({ data: { left, right, bottom, top } }),
        { fill_color: value, line_color: value });
    };
    if (card.kept) {
      const [left, right, ...ends] = series.kept;
      // Bokeh does not draw what ends too far outside of the plot.
      const [bottom, top] = ends.map((end) =>
        card.beyond ? end.map((y) => Math.min(Math.max(y, card.low - size), card.high + size)) : end);
      boxes(upper, left, right, bottom, top);
    }
    const [first, last, least, greatest] = series.results;
    boxes(lower, first, last, least.map((y) => y - HALF_BOX), greatest.map((y) => y + HALF_BOX));
    draw(upper, new Bokeh.Line({ ...at, line_width: 1.6 }), sources.line, { line_color: value });
    draw(upper, new Bokeh.Step({ ...at, mode: "after", line_width: 1.8, line_dash: [8, 3] }),
      sources.limit, { line_color: "limit" });
    draw(upper, new Bokeh.Scatter({ ...at, size: 5 }), sources.yes, { fill_color: value, line_color: value });
    draw(upper, new Bokeh.Scatter({ ...at, size: 5 }), sources.no, { fill_color: "paper", line_color: value });
    card.edges.forEach((times, above) => {
      // Where compared values are beyond the plot, whose scale is fixed then.
      const y = times.map(() => (above ? card.high - size / 40 : card.low + size / 40));
      const edge = new Bokeh.Scatter({
        ...at, size: 9, marker: { value: above ? "triangle" : "inverted_triangle" },
      });
      draw(upper, edge, new Bokeh.ColumnDataSource({ data: { x: times, y } }), { fill_color: value, line_color: value });
    });
    draw(lower, new Bokeh.Step({ ...at, mode: "after", line_width: 1.6 }), sources.result, { line_color: value });
    if (card.suggested !== null) {
      upper.add_layout(paint(
        new Bokeh.Span({ location: card.suggested, dimension: "width", line_width: 1.4, line_dash: [2, 3] }),
        { line_color: "limit" },
      ));
    }
    for (const figure of [upper, lower]) verticals(figure, [{ t: card.mark, type: card.type }], 1.5);

    const moved = () => {
      const { start, end } = range;
      const line = between(series.t, series.c, start, end, series.gap);
      const limit = between(series.lt, series.lv, start, end, Infinity);
      const result = between(series.t, series.r, start, end, series.gap);
      sources.line.data = { x: line.x, y: line.y };
      sources.limit.data = { x: limit.x, y: limit.y };
      sources.result.data = { x: result.x, y: result.y };
      const dots = { yes: { x: [], y: [] }, no: { x: [], y: [] } };
      if (line.end - line.first <= DOTS) {
        for (let i = line.first; i < line.end; i++) {
          const into = series.r[i] ? dots.yes : dots.no;
          into.x.push(series.t[i]);
          into.y.push(series.c[i]);
        }
      }
      sources.yes.data = dots.yes;
      sources.no.data = dots.no;
      // What comes into view may lie higher or lower, but one wild value must not flatten the rest.
      const most = 8 * (card.high - card.low);
      let [low, high] = [card.low, card.high];
      if (!card.beyond && (start < home[0] || end > home[1])) {
        for (const y of line.y) {
          if (y < low && y > card.low - most) low = y;
          if (y > high && y < card.high + most) high = y;
        }
      }
      if (low !== scale.start || high !== scale.end) scale.setv({ start: low, end: high });
    };
    steer(host, [upper, lower], range, whole, home, moved);
    readout(host, [upper, lower], (x) => {
      const i = Math.max(0, place(series.t, x) - 1);
      if (!series.t.length) return "";
      const now = place(series.lt, series.t[i] + 1e-9) - 1;
      const limit = card.flag ? "" : `, threshold ${number(series.lv[Math.max(0, now)])}`;
      return `${series.t[i].toFixed(3)} s: ${number(series.c[i])}${limit}, ${series.r[i] ? "true" : "false"}`;
    });
    moved();
    return [upper, lower];
  };

  return {
    paint, repaint, unpacked, missionOf, place, figureOf, withoutTimes, verticals, steer, readout, evidence,
  };
})();
