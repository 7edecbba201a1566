// The value and the threshold of one comparison over the last minutes, drawn by Bokeh.

let loading = null;

const script = (address) =>
  new Promise((resolve, reject) => {
    const element = document.createElement("script");
    element.src = address;
    element.onload = resolve;
    element.onerror = () => reject(new Error(address));
    document.head.append(element);
  });

// Only who looks at a comparison waits for a megabyte.
const bokeh = () => {
  loading ??= script("/assets/bokeh.js").then(() => script("/assets/bokeh-api.js"));
  loading.catch(() => (loading = null));
  return loading;
};

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const numbers = (values) => values.map((value) => value ?? NaN);
const dataOf = (line) => ({ t: line.t, value: numbers(line.value), threshold: numbers(line.threshold) });

export class Chart {
  constructor(place) {
    this.place = place;
    this.wanted = 0;
  }

  async draw(line) {
    this.clear();
    const { wanted } = this;
    this.place.textContent = "Drawing the chart";
    try {
      await bokeh();
    } catch {
      this.place.textContent = "The chart could not be loaded.";
      return;
    }
    if (wanted !== this.wanted) return;
    this.place.replaceChildren();
    const { Bokeh } = window;
    this.source = new Bokeh.ColumnDataSource({ data: dataOf(this.newest ?? line) });
    const figure = Bokeh.Plotting.figure({
      tools: [],
      toolbar_location: null,
      sizing_mode: "stretch_width",
      height: 220,
      output_backend: "canvas",
      background_fill_color: null,
      border_fill_color: null,
      min_border: 4,
      x_axis_label: "seconds of the mission",
    });
    for (const axis of [...figure.below, ...figure.left]) {
      axis.major_label_text_color = colour("faint");
      axis.axis_label_text_color = colour("faint");
      axis.axis_line_color = axis.major_tick_line_color = colour("edge");
      axis.minor_tick_line_color = null;
    }
    for (const grid of figure.center) grid.grid_line_color = colour("grid");
    const add = (glyph) => figure.add_glyph(glyph, this.source);
    const t = { field: "t" };
    add(new Bokeh.Step({
      x: t, y: { field: "threshold" }, mode: "after", line_width: 1.8, line_dash: [8, 3], line_color: colour("limit"),
    }));
    add(new Bokeh.Line({ x: t, y: { field: "value" }, line_width: 1.8, line_color: colour("value") }));
    add(new Bokeh.Scatter({ x: t, y: { field: "value" }, size: 3, fill_color: colour("value"), line_color: null }));
    await Bokeh.Plotting.show(figure, this.place);
  }

  update(line) {
    this.newest = line;
    if (this.source) this.source.data = dataOf(line);
  }

  clear() {
    this.wanted += 1;
    this.source = null;
    this.newest = null;
    this.place.replaceChildren();
  }
}
