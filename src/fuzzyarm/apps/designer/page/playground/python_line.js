// The line to the Python of the page: a worker that is started once.

import { S } from "../strings.js";

const P = S.playground;

/** Why this browser has no Python; empty where it has. */
export function canRunPython() {
  if (location.protocol === "file:") return P.noServer;
  if (typeof WebAssembly !== "object") return P.noWebAssembly;
  return typeof Worker === "function" ? "" : P.noWorker;
}

/**
 * A line to Python.
 *
 * @param {any} start what the page knows
 * @param {() => Record<string, string>} texts that there are
 * @param {{ doing(what: string): void, ready(): void, failed(why: string): void }} tell
 * @returns {Page.Line & { store(file: string, text: string | null): void }} `store` takes what another tab has stored
 */
export function pythonLine(start, texts, tell) {
  const parts = start.python;
  /** @type {Worker} */
  let worker;
  const line = ({ opened, heard, closed }) => {
    worker = new Worker("python.js", { type: "module" });
    let isOpen = false;
    const fail = (why) => {
      isOpen = false;
      worker.terminate();
      tell.failed(why);
      closed(false);
    };
    worker.onerror = (event) => fail(event.message || P.notLoaded);
    worker.onmessage = ({ data }) => {
      if (data.said !== undefined) heard(data.said);
      else if (data.doing) tell.doing(data.doing);
      else if (data.failed) fail(data.failed);
      else if (data.ready) {
        isOpen = true;
        tell.ready();
        opened();
        performance.mark("ready");
        keepOffline();
      }
    };
    worker.postMessage({ begin: { files: texts(), parts } });
    return { send: (said) => worker.postMessage({ said }), isOpen: () => isOpen, drop: () => fail(P.notLoaded) };
  };
  return Object.assign(line, { store: (file, text) => worker.postMessage({ stored: { file, text } }) });
}

/** Keep the page for when there is no network, where the browser lets it. */
function keepOffline() {
  navigator.serviceWorker?.register("offline.js").catch(() => null);
}
