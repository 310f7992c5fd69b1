// The connection with the server: one socket, which comes back by itself. What is said is JSON; see server.py.

import { S } from "./strings.js";

const AGAIN = 700; // ms until the next try

/** Connect; `opened` is called whenever there is a connection, `closed` when it is lost, `take` with what comes. */
export function connect({ opened, closed, take }) {
  return new Connection({ opened, closed, take }).api();
}

class Connection {
  constructor({ opened, closed, take }) {
    this.opened = opened;
    this.closed = closed;
    this.take = take;

    this.socket = null;
    this.asked = 0;
    this.begun = false; // whether there has ever been a connection
    this.early = []; // what is said before
    this.answers = new Map(); // what waits for an answer, by its number
    this.jobs = new Map(); // what hears of long work, by its number

    this.ANSWERS = {
      answer: (message) => {
        this.answers.get(message.id)?.(message);
        this.answers.delete(message.id);
      },
      job: (message) => {
        const hear = this.jobs.get(message.id);
        if (message.end) this.jobs.delete(message.id);
        hear?.(message);
      },
    };
  }

  api() {
    return {
      open: this.open,
      send: this.send,
      /** Ask of the text of a file. */
      ask: (file, asked_for) => this.question({ ...asked_for, do: "ask", file }),
      /** Save a file; the answer has an `error` where it has not been saved. */
      save: (file) => this.question({ do: "save", file }),
      /** Ask of the folder, or have something done in it. */
      folder: (asked_for) => this.question({ ...asked_for, do: "folder" }),
      /** Begin long work on a file. `hear` takes its news, the last with `end`; what comes back tells and stops it. */
      start: (file, what, asked_for, hear) => {
        const id = ++this.asked;
        if (this.send({ ...asked_for, do: "start", file, id, what })) this.jobs.set(id, hear);
        else queueMicrotask(() => hear({ end: "failed", message: S.gone }));
        return { say: (words) => this.send({ ...words, do: "say", id }), stop: () => this.send({ do: "stop", id }) };
      },
      isOpen: () => this.socket?.readyState === WebSocket.OPEN,
      drop: () => this.socket.close(),
    };
  }

  send = (message) => {
    if (!this.begun) return this.early.push(message) > 0;
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  };

  question = (message) => {
    const id = ++this.asked;
    return new Promise((resolve) => {
      if (this.send({ ...message, id })) this.answers.set(id, resolve);
      else resolve({ error: S.gone });
    });
  };

  open = () => {
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    address.hash = "";
    this.socket = new WebSocket(address);
    this.socket.onopen = () => {
      this.begun = true;
      this.opened();
      for (const message of this.early.splice(0)) this.send(message);
    };
    this.socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      (this.ANSWERS[message.is] ?? this.take)(message);
    };
    this.socket.onclose = () => {
      for (const resolve of this.answers.values()) resolve({ error: S.gone });
      this.answers.clear();
      for (const hear of this.jobs.values()) hear({ end: "failed", message: S.gone });
      this.jobs.clear();
      this.closed();
      setTimeout(this.open, AGAIN);
    };
  };
}
