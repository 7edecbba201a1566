// The page of pytpc live: takes boards from the socket, shows them, and sends marks.
import { Detail, askBegan, askName, askNote, askWhere, isOpen, showHelp, showPhone } from "./dialogs.js";
import { Link } from "./link.js";
import { View, clockText, put } from "./view.js";

const NEWS_EACH = 10_000;
const NAME = "tpc-observer";
const byId = (id) => document.getElementById(id);

const TOKEN = "tpc-token";
// The token need not stay where it is seen and copied. It is kept where only this very server's
// pages find it: cookies go to every port of a host.
const given = new URLSearchParams(location.search).get("token");
history.replaceState(null, "", "/");

const board = { near: [], held: [], turns: [], marks: [], places: [], suspects: [] };
const view = new View();
let clock = { now: 0, rate: 0, end: null, playing: null, speed: 1, known: true };
let clockAt = Date.now();
let hello = { observer: "", apply: false, recording: false, phone: false };
let changed = new Set();
let seeking = false;
let link = null;
let ended = false;
let toldTurns = null;
let toldAt = 0;

const remembered = (what) => {
  try {
    return localStorage.getItem(what);
  } catch {
    return null; // storage is switched off
  }
};
const remember = (what, text) => {
  try {
    localStorage.setItem(what, text);
  } catch {
    // It is asked for again next time.
  }
};
if (given) remember(TOKEN, given);

const missionNow = () => {
  const now = clock.now + (clock.rate * (Date.now() - clockAt)) / 1000;
  return clock.end === null ? now : Math.min(clock.end, now);
};

const say = (text, bad = false) => {
  put(byId("said"), text);
  byId("said").classList.toggle("bad", bad);
};

// Takes what is new of a board; it is drawn with the next frame, however many come before that.
const take = (changes) => {
  for (const [name, part] of Object.entries(changes)) {
    if (part.is !== undefined) {
      board[name] = part.is;
    } else {
      const rows = new Map(board[name].map((row) => [row.id, row]));
      for (const row of part.rows) rows.set(row.id, row);
      const order = part.order ?? board[name].map((row) => row.id);
      board[name] = order.map((id) => rows.get(id));
    }
    changed.add(name);
  }
  if (changes.clock) {
    clock = board.clock;
    clockAt = Date.now();
  }
  requestAnimationFrame(draw);
};

const draw = () => {
  if (changed.size === 0) return;
  const now = changed;
  changed = new Set();
  view.show(board, now);
  if (now.has("clock")) showPlayer();
  if (now.has("state")) showBanner();
  if (now.has("turns")) tellTurns();
  view.pass(missionNow());
  document.documentElement.dataset.boards = String(Number(document.documentElement.dataset.boards ?? 0) + 1);
};

const showPlayer = () => {
  if (clock.end === null) return;
  put(byId("play"), clock.playing ? "Pause" : "Play");
  byId("seek").max = String(clock.end);
  if (document.activeElement !== byId("speed")) byId("speed").value = String(clock.speed);
  pass();
};

const pass = () => {
  const now = missionNow();
  put(byId("clock"), clock.known ? clockText(now) : "no /clock yet");
  if (clock.end === null) return;
  if (!seeking) byId("seek").value = String(now);
  byId("seek").setAttribute("aria-valuetext", clockText(now));
  put(byId("at"), `${clockText(now)} of ${clockText(clock.end)}`);
};

const since = (milliseconds) => new Date(milliseconds).toLocaleTimeString();

const showBanner = () => {
  const state = board.state ?? {};
  let text = "";
  if (ended) {
    text = "This page is no longer served here: pytpc live was started again. Open the address that it printed.";
  } else if (link !== null && link.lostSince !== null) {
    const waiting = link.waiting ? `; ${link.waiting} waiting to be sent, each with its own time` : "";
    text = `No connection to pytpc live since ${since(link.lostSince)}, trying again${waiting}.`;
  } else if (state.unsaved) {
    text = state.unsaved;
  } else if (state.gone_since) {
    text = `The graph does not answer since ${since(state.gone_since * 1000)}; waiting for it.`;
  } else if (state.behind) {
    text = `Reading the recording up to here: ${Math.ceil(state.behind)} s of it are left.`;
  } else if (state.live && state.quiet_since) {
    text = `No report since ${since(state.quiet_since * 1000)}.`;
  }
  put(byId("banner"), text);
  byId("banner").hidden = text === "";
  const old = ended || (link !== null && link.lostSince !== null) || (state.gone_since && state.quiet_since) || state.behind > 0;
  byId("board").classList.toggle("old", Boolean(old));
};

// Tells readers of the screen what turned, but not more than a few times a minute.
const tellTurns = () => {
  const ids = new Set(board.turns.map((row) => row.id));
  const fresh = toldTurns === null ? [] : board.turns.filter((row) => !toldTurns.has(row.id));
  if (toldTurns !== null && (Date.now() - toldAt < NEWS_EACH || fresh.length === 0)) return;
  toldTurns = ids;
  toldAt = Date.now();
  if (!fresh.length) return;
  const names = [...new Set(fresh.map((row) => row.parameter))];
  put(byId("news"), `${names.slice(0, 3).join(", ")}${names.length > 3 ? " and others" : ""} turned`);
};

const ours = () => board.marks.filter((mark) => mark.observer === hello.observer);
const lastMark = () => ours().at(-1);
const about = (mark) => `${mark.type ? `Type ${mark.type}` : "Wrong"} at ${clockText(mark.at)}`;

const ask = async (message, doing) => {
  const asked = link.ask(message, { keep: true });
  if (!link.ready) {
    say(`${doing}: waiting for the connection (${link.waiting})`, true);
    showBanner();
  }
  const answer = await asked;
  say(answer.said || "", !answer.ok);
  showBanner();
};

const mark = (kind) => ask({ do: kind, at: Math.round(missionNow() * 1000) / 1000 }, "marked");
const undo = () => ask({ do: "undo" }, "undo");

const askAbout = async (what) => {
  const last = lastMark();
  if (!last && link.waiting === 0) {
    say("You have no mark yet: mark first.", true);
    return;
  }
  const of = last ? about(last) : "the mark that is waiting to be sent";
  let text = null;
  if (what === "note") text = await askNote(of, last ? last.remark : "");
  else if (what === "where") text = await askWhere(of, board.places);
  else text = await askBegan(of);
  if (text === null || (what !== "note" && text.trim() === "")) return;
  ask({ do: what, text }, what);
};

const player = (what, to = 0) => {
  if (hello.recording) link.ask({ do: what, to });
};
const playOrPause = () => player(clock.playing ? "pause" : "play");

const KEYS = {
  1: () => mark("1"),
  2: () => mark("2"),
  3: () => mark("3"),
  n: () => askAbout("note"),
  w: () => askAbout("where"),
  b: () => askAbout("began"),
  u: undo,
  "?": () => showHelp(hello.recording),
};
const PLAYER_KEYS = {
  " ": playOrPause,
  ArrowLeft: () => player("step", -5),
  ArrowRight: () => player("step", 5),
  ArrowDown: () => player("step", -60),
  ArrowUp: () => player("step", 60),
  ",": () => player("step", -1),
  ".": () => player("step", 1),
  "+": () => player("faster", 1),
  "=": () => player("faster", 1),
  "-": () => player("faster", -1),
};

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.isComposing || isOpen() || link === null) return;
  const at = document.activeElement;
  if (at && at.matches("input, select, textarea")) {
    // The slider has its own keys; marks go on.
    if (at.id !== "seek" || !/^[123nwbu?]$/.test(event.key)) return;
  }
  const does = KEYS[event.key] ?? (hello.recording ? PLAYER_KEYS[event.key] : undefined);
  if (does === undefined) return;
  if (event.key === " " && at && at.matches("button, summary, a")) return;
  event.preventDefault();
  // A key that is held down is one mark.
  if (!event.repeat || event.key in PLAYER_KEYS) does();
});

for (const button of document.querySelectorAll("[data-mark]")) {
  button.addEventListener("click", () => mark(button.dataset.mark));
}
for (const button of document.querySelectorAll("[data-ask]")) {
  button.addEventListener("click", () => askAbout(button.dataset.ask));
}
document.querySelector("[data-undo]").addEventListener("click", undo);
for (const button of document.querySelectorAll("[data-close]")) {
  button.addEventListener("click", () => button.closest("dialog").close());
}
byId("to-help").addEventListener("click", () => showHelp(hello.recording));
byId("to-phone").addEventListener("click", async () => {
  const answer = await link.ask({ do: "phone" });
  if (answer && answer.ok) showPhone(answer.code);
});
byId("play").addEventListener("click", playOrPause);
for (const button of document.querySelectorAll("[data-step]")) {
  button.addEventListener("click", () => player("step", Number(button.dataset.step)));
}
byId("player").addEventListener("submit", (event) => event.preventDefault());
byId("seek").addEventListener("input", () => {
  seeking = true;
});
byId("seek").addEventListener("change", () => {
  seeking = false;
  player("seek", Number(byId("seek").value));
});
byId("speed").addEventListener("change", () => player("speed", Number(byId("speed").value)));
byId("who").addEventListener("click", async () => {
  const name = await askName(hello.observer);
  if (name === null || name.trim() === hello.observer) return;
  const answer = await link.rename(name.trim());
  if (answer && answer.ok) remember(NAME, name.trim());
  say(answer ? answer.said || `You mark as ${name.trim()} now.` : "not connected", !(answer && answer.ok));
});

const detail = new Detail((message) => link.ask(message));
document.addEventListener("click", async (event) => {
  const row = event.target.closest("button[data-key]");
  if (row === null) return;
  const wrong = await detail.show(row.dataset.key, row.dataset.node, hello.apply);
  if (wrong) say(wrong, true);
});

addEventListener("beforeunload", (event) => {
  // Marks that wait for the connection would be lost.
  if (link !== null && link.waiting > 0) event.preventDefault();
});

link = new Link(
  {
    hello: (found) => {
      hello = found;
      if (remembered(NAME) === null) remember(NAME, found.observer);
      put(byId("who"), found.observer || "no name");
      byId("who").setAttribute("aria-label", `Observer ${found.observer}: change the name`);
      byId("player").hidden = !found.recording;
      byId("to-phone").hidden = !found.phone;
      detail.again();
    },
    board: take,
    line: (key, line) => detail.line(key, line),
    state: (state, why) => {
      ended = state === "refused" || (ended && state !== "open");
      document.documentElement.dataset.link = state;
      if (state === "lost" && why) say(why, true);
      showBanner();
    },
  },
  remembered(NAME),
  given || remembered(TOKEN) || "",
);
setInterval(() => {
  pass();
  view.pass(missionNow());
}, 250);
