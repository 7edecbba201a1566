// The socket to pytpc: asks and answers, reconnects, and keeps what must not be lost.

const FIRST_WAIT = 500;
const LONGEST_WAIT = 8000;
const SILENCE = 6000; // a server that is there says something each second
const AGAIN = 1200;

export class Link {
  // `on` has the functions hello, board, line and state; state gets "open", "lost" or "refused".
  constructor(on, observer, token) {
    this.on = on;
    this.token = token;
    this.observer = observer;
    this.ready = false;
    this.asked = new Map();
    this.wait = FIRST_WAIT;
    this.lastId = 0;
    this.run = Math.random().toString(36).slice(2, 10);
    this.heard = Date.now();
    this.lostSince = null;
    setInterval(() => this.watch(), 1000);
    addEventListener("online", () => this.open());
    document.addEventListener("visibilitychange", () => {
      if (!document.hidden && !this.ready) this.open();
    });
    this.open();
  }

  // Asks; `keep`: until it is answered, also over a lost connection. The answer, or null without one.
  ask(message, { keep = false } = {}) {
    const id = `${this.run}-${++this.lastId}`;
    return new Promise((resolve) => {
      if (!this.ready && !keep && message.do !== "hello") {
        resolve(null);
        return;
      }
      const asked = { id, message, keep, resolve, made: Date.now() };
      this.asked.set(id, asked);
      if (this.ready || message.do === "hello") this.send(asked);
    });
  }

  // How many kept messages wait for an answer.
  get waiting() {
    return [...this.asked.values()].filter((one) => one.keep).length;
  }

  send(asked) {
    const { at, ...rest } = asked.message;
    // The time of a mark is that of the key. The server knows it better, unless this comes late.
    const late = Date.now() - asked.made > 1000;
    this.socket.send(JSON.stringify({ ...rest, ...(late && at !== undefined ? { at } : {}), id: asked.id }));
  }

  open() {
    clearTimeout(this.timer);
    if (this.socket && this.socket.readyState < WebSocket.CLOSING) return;
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/socket`);
    this.socket = socket;
    this.heard = Date.now();
    socket.onopen = () => this.greet(socket);
    socket.onmessage = (event) => {
      if (socket === this.socket) this.take(JSON.parse(event.data));
    };
    socket.onclose = (event) => {
      if (socket === this.socket) this.lose(event.code >= 4000 ? event.reason : "");
    };
  }

  async greet(socket) {
    const answer = await this.ask({ do: "hello", observer: this.observer, token: this.token });
    if (socket !== this.socket || answer === null) return;
    if (!answer.ok && this.observer !== null) {
      // A name that was kept from an earlier time, and that cannot be used now.
      this.observer = null;
      this.greet(socket);
      return;
    }
    this.observer = answer.hello.observer;
    this.ready = true;
    this.wait = FIRST_WAIT;
    this.lostSince = null;
    this.on.hello(answer.hello, answer.said);
    this.on.state("open", "");
    for (const asked of this.asked.values()) this.send(asked);
  }

  // Uses another name; the answer of the server.
  async rename(name) {
    const answer = await this.ask({ do: "hello", observer: name });
    if (answer && answer.ok) {
      this.observer = answer.hello.observer;
      this.on.hello(answer.hello, answer.said);
    }
    return answer;
  }

  take(message) {
    this.heard = Date.now();
    if (message.board !== undefined) {
      this.on.board(message.changes);
      this.socket.send('{"do":"seen"}');
    } else if (message.line !== undefined) {
      this.on.line(message.key, message.line);
    } else if (message.done !== undefined) {
      this.answered(message);
    }
  }

  answered(message) {
    const asked = this.asked.get(message.done);
    if (asked === undefined) return;
    if (message.refused && asked.keep) {
      setTimeout(() => this.ready && this.asked.has(asked.id) && this.send(asked), AGAIN);
      return;
    }
    this.asked.delete(message.done);
    asked.resolve(message);
  }

  watch() {
    if (this.ready && Date.now() - this.heard > SILENCE) {
      const socket = this.socket;
      this.lose("");
      socket.close();
    }
  }

  lose(why) {
    this.ready = false;
    this.socket.onclose = null;
    this.socket = null;
    this.lostSince ??= Date.now();
    for (const [id, asked] of this.asked) {
      if (asked.keep) continue;
      this.asked.delete(id);
      asked.resolve(null);
    }
    this.on.state("lost", why);
    const wait = this.wait * (0.75 + Math.random() / 2);
    this.wait = Math.min(LONGEST_WAIT, this.wait * 2);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.again(), wait);
  }

  async again() {
    try {
      // A socket does not say why it is not let in.
      const found = await fetch("/assets/live.css", { cache: "no-store" });
      if (found.status === 403 || found.status === 421) this.on.state("refused", "");
    } catch {
      // Nobody answers; so will the socket find.
    }
    this.open();
  }
}
