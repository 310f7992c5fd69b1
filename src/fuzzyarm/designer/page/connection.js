// The connection with the server: one socket, which comes back by itself. What is said is JSON; see server.py.

import { S } from "./strings.js";

const AGAIN = 700; // ms until the next try

/** Connect; `opened` is called whenever there is a connection, `closed` when it is lost, `take` with what comes. */
export function connect({ opened, closed, take }) {
  let socket = null;
  let asked = 0;
  let begun = false; // whether there has ever been a connection
  const early = []; // what is said before
  const answers = new Map(); // what waits for an answer, by its number
  const jobs = new Map(); // what hears of long work, by its number

  function send(message) {
    if (!begun) return early.push(message) > 0;
    if (socket?.readyState !== WebSocket.OPEN) return false;
    socket.send(JSON.stringify(message));
    return true;
  }

  function question(message) {
    const id = ++asked;
    return new Promise((resolve) => {
      if (send({ ...message, id })) answers.set(id, resolve);
      else resolve({ error: S.gone });
    });
  }

  const ANSWERS = {
    answer(message) {
      answers.get(message.id)?.(message);
      answers.delete(message.id);
    },
    job(message) {
      const hear = jobs.get(message.id);
      if (message.end) jobs.delete(message.id);
      hear?.(message);
    },
  };

  function open() {
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    address.hash = "";
    socket = new WebSocket(address);
    socket.onopen = () => {
      begun = true;
      opened();
      for (const message of early.splice(0)) send(message);
    };
    socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      (ANSWERS[message.is] ?? take)(message);
    };
    socket.onclose = () => {
      for (const resolve of answers.values()) resolve({ error: S.gone });
      answers.clear();
      for (const hear of jobs.values()) hear({ end: "failed", message: S.gone });
      jobs.clear();
      closed();
      setTimeout(open, AGAIN);
    };
  }

  return {
    open,
    send,
    /** Ask of the text of a file. */
    ask: (file, asked_for) => question({ ...asked_for, do: "ask", file }),
    /** Save a file; the answer has an `error` where it has not been saved. */
    save: (file) => question({ do: "save", file }),
    /** Ask of the folder, or have something done in it. */
    folder: (asked_for) => question({ ...asked_for, do: "folder" }),
    /** Begin long work on a file. `hear` takes its news, the last with `end`; what comes back tells and stops it. */
    start(file, what, asked_for, hear) {
      const id = ++asked;
      if (send({ ...asked_for, do: "start", file, id, what })) jobs.set(id, hear);
      else queueMicrotask(() => hear({ end: "failed", message: S.gone }));
      return { say: (words) => send({ ...words, do: "say", id }), stop: () => send({ do: "stop", id }) };
    },
    isOpen: () => socket?.readyState === WebSocket.OPEN,
    drop: () => socket.close(),
  };
}
