// The figure of a whole mission: results of the suspects, both rank curves, the marks; one time axis.
const tpcTimeline = (() => {
  "use strict";
  const { paint, unpacked, missionOf, place, figureOf, withoutTimes, verticals, steer, readout } = tpcFigures;
  const HEIGHTS = { 1: 0.08, 2: 0.62, 3: 0.34 }; // false, true, both
  const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3], [4, 4], [12, 3], [2, 6], [7, 2, 2, 2]];
  const MOST = 1500; // steps of a curve: one for each column of pixels
  const LANE = 24;

  const shortened = (text, most) => (text.length <= most ? text : `${text.slice(0, most - 1)}…`);

  const lanesOf = (mission, common, narrow) => {
    const { labels, columns, runs, accent, culprit } = mission.timeline;
    const rows = labels.map((_, row) => row);
    const figure = figureOf({
      ...common, height: LANE * labels.length + 30,
      y_range: new Bokeh.Range1d({ start: labels.length - 0.4, end: -1.1 }),
    });
    const axis = figure.left[0];
    axis.ticker = new Bokeh.FixedTicker({ ticks: rows });
    axis.major_label_overrides = new Map(rows.map((row) => [row, shortened(labels[row], narrow ? 14 : 26)]));
    paint(axis, { major_label_text_color: "ink" });
    figure.center[1].visible = false;
    const width = mission.seconds / columns;
    rows.forEach((row) => {
      const found = unpacked(runs[row], Int32Array);
      const data = { left: [], right: [], top: [], bottom: [] };
      for (let i = 0; i < found.length; i += 3) {
        const half = HEIGHTS[found[i]] / 2;
        data.left.push(found[i + 1] * width);
        data.right.push((found[i + 1] + found[i + 2]) * width);
        data.top.push(row + half);
        data.bottom.push(row - half);
      }
      const glyph = new Bokeh.Quad({
        left: { field: "left" }, right: { field: "right" }, top: { field: "top" }, bottom: { field: "bottom" },
        line_width: 1.2, // so that a single evaluation is seen in a long mission
      });
      const renderer = figure.add_glyph(glyph, new Bokeh.ColumnDataSource({ data }));
      const name = row === accent ? (culprit ? "culprit" : "value") : "lane";
      paint(renderer.glyph, { fill_color: name, line_color: name });
    });
    const numbers = new Bokeh.ColumnDataSource({
      data: {
        x: mission.marks.map((mark) => mark.t), y: mission.marks.map(() => -0.72),
        text: mission.marks.map((_, i) => String(i + 1)),
      },
    });
    const text = new Bokeh.Text({
      x: { field: "x" }, y: { field: "y" }, text: { field: "text" }, text_align: "left", x_offset: 4,
      text_baseline: "middle", text_font_size: "12px", text_font_style: "bold",
    });
    paint(figure.add_glyph(text, numbers).glyph, { text_color: "ink" });
    return figure;
  };

  const curvesOf = (mission, common, type) => {
    const { curves, accent, culprit } = mission.timeline;
    const figure = figureOf({
      ...common, height: type === "II" ? 146 : 120,
      y_range: new Bokeh.Range1d({ start: -0.04, end: 1.06 }), y_axis_label: `rank, type ${type}`,
    });
    figure.left[0].ticker = figure.center[1].ticker = new Bokeh.FixedTicker({ ticks: [0, 0.5, 1] });
    const lines = curves[type].map((packed, row) => {
      const values = Float64Array.from(unpacked(packed, Uint16Array), (rank) => rank / 65535);
      const source = new Bokeh.ColumnDataSource({ data: { x: [], y: [] } });
      const glyph = new Bokeh.Step({
        x: { field: "x" }, y: { field: "y" }, mode: "after",
        line_width: row === accent ? 2.4 : 1.2, line_dash: DASHES[row % DASHES.length],
      });
      const renderer = figure.add_glyph(glyph, source);
      if (row === accent) renderer.level = "annotation";
      paint(renderer.glyph, { line_color: row === accent ? (culprit ? "culprit" : "value") : `curve${row % 7}` });
      return { values, source, renderer };
    });
    return { figure, lines };
  };

  // A key to the curves: a press shows one curve alone, another press all of them again.
  const keyOf = (host, mission, groups, moved) => {
    const { labels, accent, culprit } = mission.timeline;
    const key = document.createElement("div");
    key.className = "curve-key";
    labels.forEach((label, row) => {
      const button = document.createElement("button");
      button.type = "button";
      button.setAttribute("aria-pressed", "false");
      const sample = document.createElementNS("http://www.w3.org/2000/svg", "svg");
      sample.setAttribute("viewBox", "0 0 28 8");
      const line = document.createElementNS("http://www.w3.org/2000/svg", "path");
      line.setAttribute("d", "M0 4H28");
      line.setAttribute("stroke-dasharray", DASHES[row % DASHES.length].join(" "));
      line.setAttribute("class", row === accent ? (culprit ? "culprit" : "value") : `curve${row % 7}`);
      sample.append(line);
      button.append(sample, label);
      button.addEventListener("click", () => {
        const alone = button.getAttribute("aria-pressed") !== "true";
        for (const other of key.children) other.setAttribute("aria-pressed", "false");
        button.setAttribute("aria-pressed", String(alone));
        for (const lines of groups) {
          lines.forEach(({ renderer }, place) => { renderer.visible = !alone || place === row; });
        }
        moved();
      });
      key.append(button);
    });
    host.append(key);
  };

  const timeline = (host) => {
    const mission = missionOf(host.dataset.mission);
    const { curves, labels } = mission.timeline;
    const narrow = host.clientWidth < 640;
    const margin = (mission.seconds || 1) * 0.006;
    const home = [-margin, (mission.seconds || 1) + margin];
    const range = new Bokeh.Range1d({ start: home[0], end: home[1], bounds: home });
    const common = { x_range: range, min_border_left: narrow ? 110 : 190, min_border_right: 12 };
    const lanes = lanesOf(mission, common, narrow);
    const figures = [lanes];
    const groups = [];
    let times = null;
    if (curves) {
      times = unpacked(curves.t, Float64Array);
      for (const type of ["I", "II"]) {
        const { figure, lines } = curvesOf(mission, common, type);
        figures.push(figure);
        groups.push(lines);
      }
    }
    figures.slice(0, -1).forEach(withoutTimes);
    figures[figures.length - 1].below[0].axis_label = "seconds since the recording began";
    for (const figure of figures) verticals(figure, mission.marks, 1.2);
    const moved = () => {
      if (times === null) return;
      const first = Math.max(0, place(times, range.start) - 1);
      const end = Math.min(times.length, place(times, range.end) + 1);
      const stride = Math.max(1, Math.ceil((end - first) / MOST));
      for (const lines of groups) {
        for (const { values, source, renderer } of lines) {
          if (!renderer.visible) continue;
          // A rank stays for a while: of a step line its steps are all that is to be drawn.
          const x = [];
          const y = [];
          for (let i = first; i < end; i += stride) {
            if (i > first && values[i] === y[y.length - 1] && i + stride < end) continue;
            x.push(times[i]);
            y.push(values[i]);
          }
          source.data = { x, y };
        }
      }
    };
    steer(host, figures, range, home, home, moved);
    if (curves) keyOf(host, mission, groups, moved);
    readout(host, figures, (x) => {
      const after = mission.marks.findIndex((mark) => mark.t > x);
      const count = after === -1 ? mission.marks.length : after;
      let text = `${x.toFixed(2)} s, after ${count} of ${mission.marks.length} marks`;
      if (times !== null && times.length) {
        const i = Math.max(0, place(times, x) - 1);
        const ranked = ["I", "II"].map((type, group) => {
          const values = groups[group].map(({ values: all }) => all[i]);
          const best = values.indexOf(Math.max(...values));
          return values[best] > 0 ? `${type}: ${labels[best]} ${values[best].toFixed(2)}` : `${type}: none`;
        });
        text += `; highest of these, type ${ranked.join(", type ")}`;
      }
      return text;
    });
    lanes.on_event("tap", (event) => {
      const reach = (range.end - range.start) * 0.015;
      const near = mission.marks.findIndex((mark) => Math.abs(mark.t + reach / 2 - event.x) < reach);
      if (near >= 0) location.hash = `#${host.dataset.mission}-${near + 1}`;
    });
    moved();
    return figures;
  };

  return { timeline };
})();
