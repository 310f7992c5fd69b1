// The connection with what answers the page: a line that comes back by itself. What is said is JSON; see open_files.py.

const AGAIN = 700; // ms until the next try

/**
 * A line to the server that this page comes from.
 *
 * A line is a function of what is to be called when it is there, when it brings a text, and when it is lost, and whether
 * it is to be tried again then.
 *
 * @type {Page.Line}
 */
export function socketLine({ opened, heard, closed }) {
  const address = new URL("socket", location.href);
  address.protocol = "ws:";
  address.hash = "";
  const socket = new WebSocket(address);
  socket.onopen = opened;
  socket.onmessage = (event) => heard(event.data);
  socket.onclose = () => closed(true);
  return {
    send: (text) => socket.send(text),
    isOpen: () => socket.readyState === WebSocket.OPEN,
    drop: () => socket.close(),
  };
}

/** A connection; `opened` is called whenever there is one, `closed` when it is lost, `take` with what comes. */
export class Connection {
  constructor({ opened, closed, take, gone }, line = socketLine) {
    this.opened = opened;
    this.closed = closed;
    this.take = take;
    this.gone = gone; // says why nothing answers
    this.makeLine = line;

    /** @type {ReturnType<Page.Line>} */
    this.line = null;
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

  /** Ask of the text of a file. */
  ask = (file, asked_for) => this.question({ ...asked_for, do: "ask", file });

  /** Save a file; the answer has an `error` where it has not been saved. */
  save = (file) => this.question({ do: "save", file });

  /** Ask of the folder, or have something done in it. */
  folder = (asked_for) => this.question({ ...asked_for, do: "folder" });

  /** Begin long work on a file. `hear` takes its news, the last with `end`; what comes back tells and stops it. */
  start = (file, what, asked_for, hear) => {
    const id = ++this.asked;
    if (this.send({ ...asked_for, do: "start", file, id, what })) this.jobs.set(id, hear);
    else queueMicrotask(() => hear({ end: "failed", message: this.gone().why }));
    return { say: (words) => this.send({ ...words, do: "say", id }), stop: () => this.send({ do: "stop", id }) };
  };

  drop = () => this.line.drop();

  isOpen = () => Boolean(this.line?.isOpen());

  send = (message) => {
    if (!this.begun) return this.early.push(message) > 0;
    if (!this.isOpen()) return false;
    this.line.send(JSON.stringify(message));
    return true;
  };

  question = (message) => {
    const id = ++this.asked;
    return new Promise((resolve) => {
      if (this.send({ ...message, id })) this.answers.set(id, resolve);
      else resolve({ error: this.gone().why });
    });
  };

  open = () => {
    this.line = this.makeLine({ opened: this.begin, heard: this.hear, closed: this.end });
  };

  begin = () => {
    this.begun = true;
    this.opened();
    for (const message of this.early.splice(0)) this.send(message);
  };

  hear = (text) => {
    const message = JSON.parse(text);
    (this.ANSWERS[message.is] ?? this.take)(message);
  };

  end = (again) => {
    for (const resolve of this.answers.values()) resolve({ error: this.gone().why });
    this.answers.clear();
    for (const hear of this.jobs.values()) hear({ end: "failed", message: this.gone().why });
    this.jobs.clear();
    this.early = []; // nobody waits for it any more
    this.closed();
    if (again) setTimeout(this.open, AGAIN);
    else this.begun = true; // it does not come back: nothing is kept for it
  };
}
