// The dialogs: note, where, when it began, the observer's name, the keys, a phone, a comparison.
import { Chart } from "./chart.js";
import { make, put } from "./view.js";

const MOST_SHOWN = 60;
const dialog = (name) => document.getElementById(`${name}-dialog`);

const open = (found) => {
  if (!found.open) found.showModal();
};

export const isOpen = () => document.querySelector("dialog[open]") !== null;

// A dialog with one text; resolves to it, or to null if it was closed without.
const askText = (found, about, text) => {
  const input = found.querySelector("input");
  const of = found.querySelector(".of");
  if (of) put(of, about);
  input.value = text;
  found.returnValue = "";
  open(found);
  input.select();
  return new Promise((resolve) => {
    found.addEventListener("close", () => resolve(found.returnValue === "ok" ? input.value : null), { once: true });
  });
};

export const askNote = (about, text) => askText(dialog("note"), about, text);
export const askBegan = (about) => askText(dialog("began"), about, "");
export const askName = (name) => askText(dialog("observer"), "", name);

export const askWhere = (about, places) => {
  const found = dialog("where");
  const input = found.querySelector("input");
  const choices = found.querySelector(".choices");
  const show = () => {
    const wanted = input.value.trim().toLowerCase();
    const fitting = places.filter((place) => place.id.toLowerCase().includes(wanted));
    const buttons = fitting.slice(0, MOST_SHOWN).map((place) => {
      const button = make("button");
      button.type = "button";
      button.append(make("span", "", place.id), make("small", "", place.about ? `  ${place.about}` : ""));
      button.addEventListener("click", () => {
        input.value = place.id;
        found.close("ok");
      });
      return button;
    });
    const left = fitting.length - buttons.length;
    if (left > 0) buttons.push(make("small", "", `${left} more: type a part of the name`));
    if (!places.length) buttons.push(make("small", "", "No place is known: type a name."));
    choices.replaceChildren(...buttons);
  };
  const answer = askText(found, about, "");
  show();
  input.addEventListener("input", show);
  found.addEventListener("close", () => input.removeEventListener("input", show), { once: true });
  return answer;
};

export const showHelp = (isRecording) => {
  for (const element of document.querySelectorAll(".of-player")) element.hidden = !isRecording;
  open(dialog("help"));
};

export const showPhone = (svg) => {
  const found = dialog("phone");
  found.querySelector("img").src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
  open(found);
};

// One comparison: its values, its source, and, if the server allows it, a change of its parameter.
export class Detail {
  constructor(ask) {
    this.ask = ask;
    this.dialog = dialog("detail");
    this.chart = new Chart(document.getElementById("chart"));
    this.key = null;
    this.planned = null;
    this.dialog.addEventListener("close", () => {
      this.key = null;
      this.chart.clear();
      this.ask({ do: "close" });
    });
    document.getElementById("plan").addEventListener("click", () => this.plan());
    document.getElementById("apply").addEventListener("click", () => this.apply());
    this.input.addEventListener("input", () => this.forget());
    this.input.addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault();
      this.plan();
    });
  }

  get input() {
    return document.querySelector("#change input");
  }

  async show(key, node, mayChange) {
    const answer = await this.ask({ do: "open", key, node });
    if (!answer || !answer.ok) return answer ? answer.said : "not connected";
    this.key = key;
    this.node = node;
    this.detail = answer.detail;
    this.fill(answer.detail);
    document.getElementById("change").hidden = !mayChange;
    this.input.value = "";
    this.forget();
    open(this.dialog);
    this.chart.draw(answer.detail.line);
    return "";
  }

  fill(detail) {
    put(document.getElementById("detail-title"), detail.parameter);
    const about = [detail.place, detail.function, detail.topic, detail.transform && `threshold = ${detail.transform}`];
    put(this.dialog.querySelector(".of"), about.filter(Boolean).join(" · "));
    put(this.dialog.querySelector(".note"), detail.note);
    const source = document.getElementById("source");
    const lines = detail.source.map((line) => {
      const text = `${String(line.number).padStart(5)} ${line.here ? ">" : " "} ${line.text}\n`;
      return make("span", line.here ? "here" : "", text);
    });
    source.replaceChildren(...lines);
    source.hidden = lines.length === 0;
    const steps = detail.way.map((step) => make("li", step.here ? "here" : "", `${step.place}  ${step.what}`));
    document.getElementById("way").replaceChildren(...steps);
    this.dialog.querySelector("details").hidden = steps.length === 0;
  }

  // The connection is back: the server does not know any more what was looked at.
  again() {
    if (this.key !== null) this.ask({ do: "open", key: this.key, node: this.node });
  }

  line(key, line) {
    if (key === this.key) this.chart.update(line);
  }

  forget() {
    this.planned = null;
    document.getElementById("diff").hidden = true;
    document.getElementById("apply").hidden = true;
    this.say("");
  }

  say(text) {
    put(document.querySelector("#change [role=status]"), text);
  }

  async plan() {
    this.forget();
    const answer = await this.ask({ do: "plan", parameter: this.detail.parameter, value: this.input.value });
    if (!answer || !answer.ok) {
      this.say(answer ? answer.said : "not connected");
      return;
    }
    this.planned = answer.plan.number;
    const diff = document.getElementById("diff");
    put(diff, [answer.plan.title, ...answer.plan.lines].join("\n"));
    diff.hidden = false;
    document.getElementById("apply").hidden = false;
    this.say("Nothing is changed yet.");
  }

  async apply() {
    const number = this.planned;
    this.forget();
    if (number === null) return;
    const answer = await this.ask({ do: "apply", plan: number });
    this.say(answer ? answer.said : "not connected: look at the value before you try again");
  }
}
