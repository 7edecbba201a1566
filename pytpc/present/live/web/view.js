// Draws the parts of a board. All texts are set as text: nothing of the robot is ever markup.

const SVG = "http://www.w3.org/2000/svg";
const JUST = 3; // seconds
const NEAR = 0.05;
export const FIRST_ROWS = 8;
const TYPES = { I: "should not have", II: "should be doing", "": "wrong" };

export const clockText = (seconds) => {
  const sign = seconds < 0 ? "-" : "";
  const tenths = Math.floor(Math.abs(seconds) * 10 + 1e-6);
  const minutes = Math.floor(tenths / 600);
  const rest = tenths % 600;
  const hours = Math.floor(minutes / 60);
  const two = (n) => String(n).padStart(2, "0");
  const head = hours ? `${hours}:${two(minutes % 60)}` : `${minutes}`;
  return `${sign}${head}:${two(Math.floor(rest / 10))}.${rest % 10}`;
};

export const spanText = (seconds) => {
  if (!(seconds >= 0)) return "0 s";
  if (seconds < 120) return `${Math.floor(seconds)} s`;
  return seconds < 7200 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
};

export const put = (element, text) => {
  if (element.textContent !== text) element.textContent = text;
};

export const make = (tag, className = "", text = "") => {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text) element.textContent = text;
  return element;
};

const result = (row) => (row.res === null ? "" : row.res ? "true" : "false");

export const nowText = (row) =>
  row.relation === "flag" ? (row.res ? "on" : "off") : row.value === "" ? "" : `${row.value} ${row.relation} ${row.threshold}`;

const fileOf = (row) => row.place.split("/").at(-1);

const marginText = (row) => (row.margin === "" ? "" : `${row.margin}${row.in_unit ? "" : "*"}`);

// Bars of the window's parts: a low one is near the threshold.
const trend = () => {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("class", "trend");
  svg.setAttribute("viewBox", "0 0 74 20");
  svg.setAttribute("aria-hidden", "true");
  return svg;
};
const drawTrend = (svg, row) => {
  const wanted = row.trend.length;
  while (svg.childNodes.length > wanted) svg.lastChild.remove();
  while (svg.childNodes.length < wanted) svg.append(document.createElementNS(SVG, "rect"));
  const width = 74 / wanted;
  row.trend.forEach((share, n) => {
    const rect = svg.childNodes[n];
    const flopped = row.flops[n];
    const height = flopped ? 20 : share === null ? 0 : Math.max(1.5, share * 20);
    const values = { x: n * width + 0.75, y: 20 - height, width: width - 1.5, height, class: flopped ? "flop" : "bar" };
    for (const [name, value] of Object.entries(values)) rect.setAttribute(name, value);
  });
};

// One row of comparisons: its name, what is compared now, the margin, and more about it.
const comparisonRow = () => {
  const item = make("li");
  const row = make("button", "row");
  row.type = "button";
  const parts = {
    name: make("span", "name"),
    now: make("span", "now"),
    more: make("span", "more-text"),
    margin: make("span", "margin"),
    code: make("span", "code"),
  };
  parts.what = make("span");
  parts.file = make("span", "file");
  parts.more.append(parts.what, parts.file);
  parts.text = make("b");
  parts.trend = trend();
  parts.margin.append(parts.trend, make("span", "unseen", " margin "), parts.text);
  row.append(parts.name, parts.now, parts.more, parts.margin, parts.code);
  item.append(row);
  item.parts = parts;
  item.row = row;
  return item;
};

const withText = (row) => (row.members.length ? `with ${row.members.join(", ")}: they ${row.turning}` : "");

const fillNear = (item, row) => {
  const { name, now, text, trend: svg, code, file } = item.parts;
  put(name, row.shared ? `${row.parameter} in ${row.node}` : row.parameter);
  put(now, nowText(row));
  put(text, marginText(row));
  text.title = row.in_unit ? "by so much the parameter would have to change" : "* difference of the compared values";
  drawTrend(svg, row);
  put(code, withText(row));
  put(file, ` · ${fileOf(row)}`);
  item.row.dataset.key = row.key;
  item.row.dataset.node = row.node;
  item.classList.toggle("near-it", row.share !== null && row.share < NEAR);
};
const ageNear = (item, row, now) => {
  const since = now - row.since;
  const late = now - row.last > JUST ? `, reported ${spanText(now - row.last)} ago` : "";
  item.classList.toggle("just", since < JUST && since >= 0);
  put(item.parts.what, `${result(row)} for ${spanText(since)}${row.topic ? ` · ${row.topic}` : ""}${late}`);
};
const ageHeld = (item, row, now) => {
  const exposes = row.topic ? `${row.topic} depends on it` : "what it exposes has no constant name";
  put(item.parts.what, `${result(row)} for ${spanText(now - row.since)} · ${exposes}`);
};

const fillTurn = (item, row) => {
  const { name, now, text, code, margin } = item.parts;
  put(name, row.parameter);
  put(now, `${nowText(row)} → ${row.result ? "true" : "false"}`);
  put(text, "");
  margin.hidden = true;
  put(code, `${fileOf(row)}  ${row.code}`);
  item.row.dataset.key = row.key;
  item.row.dataset.node = row.node;
};
const ageTurn = (item, row, now) =>
  put(item.parts.what, `${spanText(now - row.at)} ago${row.topic ? ` · ${row.topic}` : ""}`);

const fillSuspect = (item, row) => {
  const { name, now, text, code, margin } = item.parts;
  if (!item.parts.rank) {
    item.parts.rank = make("span", "rank");
    item.parts.label = make("span");
    name.append(item.parts.rank, item.parts.label);
  }
  put(item.parts.rank, row.position);
  put(item.parts.label, row.parameter);
  put(now, nowText(row));
  put(text, row.score);
  text.title = "score: a low one is suspicious";
  margin.firstChild.toggleAttribute("hidden", true);
  put(code, `${fileOf(row)}  ${row.code}`);
  if (!item.parts.others) item.row.append((item.parts.others = make("span", "code")));
  put(item.parts.others, withText(row));
  item.row.dataset.key = row.key;
  item.row.dataset.node = row.node;
};
const ageSuspect = (item, row, now) =>
  put(item.parts.what, row.flop === null ? "never turned" : `turned ${spanText(now - row.flop)} ago`);

const markRow = () => {
  const item = make("li");
  const row = make("div", "row");
  const parts = { name: make("span", "name"), now: make("span", "now"), more: make("span", "more-text") };
  parts.tag = make("span", "tag");
  parts.who = make("span");
  parts.name.append(parts.tag, parts.who);
  row.append(parts.name, parts.now, parts.more);
  item.append(row);
  item.parts = parts;
  return item;
};
const fillMark = (item, row) => {
  const { tag, who, now, more } = item.parts;
  put(tag, TYPES[row.type]);
  tag.className = `tag ${row.type}`;
  put(who, row.observer ? ` ${row.observer}` : "");
  put(now, clockText(row.at));
  put(more, [row.note ? `“${row.note}”` : "", row.suspects || "made earlier"].filter(Boolean).join(" · "));
};

const PARTS = {
  near: [comparisonRow, fillNear, ageNear],
  held: [comparisonRow, fillNear, ageHeld],
  turns: [comparisonRow, fillTurn, ageTurn],
  marks: [markRow, fillMark, null],
};

// A list whose rows keep their elements, so that a row can be focused while the board changes.
class Rows {
  constructor(list, [create, fill, age]) {
    Object.assign(this, { list, create, fill, age, items: new Map() });
  }

  show(rows) {
    const here = new Set(rows.map((row) => row.id));
    for (const [id, { item }] of this.items) {
      if (here.has(id)) continue;
      item.remove();
      this.items.delete(id);
    }
    const focused = document.activeElement;
    rows.forEach((row, n) => {
      let known = this.items.get(row.id);
      if (known === undefined) {
        known = { item: this.create(), row: null };
        this.items.set(row.id, known);
      }
      if (known.row !== row) {
        known.row = row;
        this.fill(known.item, row);
      }
      known.item.classList.toggle("extra", n >= FIRST_ROWS);
      if (this.list.children[n] !== known.item) this.list.insertBefore(known.item, this.list.children[n] ?? null);
    });
    if (focused !== document.activeElement && this.list.contains(focused)) focused.focus({ preventScroll: true });
  }

  pass(now) {
    if (this.age === null) return;
    for (const { item, row } of this.items.values()) this.age(item, row, now);
  }
}

export class View {
  constructor() {
    this.lists = new Map();
    for (const list of document.querySelectorAll("[data-part]")) {
      this.lists.set(list.dataset.part, new Rows(list, PARTS[list.dataset.part]));
    }
    this.rankings = new Map();
    for (const button of document.querySelectorAll("[data-more]")) {
      button.addEventListener("click", () => {
        const list = this.lists.get(button.dataset.more).list;
        button.setAttribute("aria-expanded", String(list.classList.toggle("all")));
        this.label(button);
      });
    }
  }

  label(button) {
    const { list, items } = this.lists.get(button.dataset.more);
    button.hidden = items.size <= FIRST_ROWS;
    put(button, list.classList.contains("all") ? "Show fewer" : `Show all ${items.size}`);
  }

  // Shows the parts that changed.
  show(board, changed) {
    for (const [name, rows] of this.lists) {
      if (!changed.has(name)) continue;
      rows.show(name === "marks" ? [...board.marks].reverse() : board[name]);
      document.querySelector(`[data-none="${name}"]`).hidden = board[name].length > 0;
      this.label(document.querySelector(`[data-more="${name}"]`));
    }
    if (changed.has("suspects")) this.showSuspects(board.suspects);
    if (changed.has("window_s")) {
      for (const element of document.querySelectorAll(".window")) put(element, String(board.window_s));
    }
    if (changed.has("state")) this.showState(board.state);
  }

  showSuspects(suspects) {
    const place = document.getElementById("rankings");
    for (const ranking of suspects) {
      let known = this.rankings.get(ranking.id);
      if (known === undefined) {
        const box = make("div");
        known = { title: make("h3"), why: make("p", "none"), list: make("ol", "rows all") };
        box.append(known.title, known.why, known.list);
        place.append(box);
        known.rows = new Rows(known.list, [comparisonRow, fillSuspect, ageSuspect]);
        this.rankings.set(ranking.id, known);
      }
      put(known.title, ranking.title);
      put(known.why, ranking.reason || (ranking.rows.length ? "" : "No parameter has a score yet."));
      known.why.hidden = known.why.textContent === "";
      known.rows.show(ranking.rows);
    }
  }

  showState(state) {
    put(document.getElementById("title"), state.title || "pytpc live");
    // The clock of a recording is shown by its player.
    const said = [state.counts, ...(state.live ? state.lines : state.lines.slice(1))].filter(Boolean);
    put(document.getElementById("state"), said.join(" · "));
  }

  // Time passes.
  pass(now) {
    for (const rows of this.lists.values()) rows.pass(now);
    for (const { rows } of this.rankings.values()) rows.pass(now);
  }
}
