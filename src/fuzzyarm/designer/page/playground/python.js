// The Python of the page, in a worker of its own: it loads Pyodide and fuzzyarm, and hands texts to and fro.
//
// What it is told: `begin` (the files that are there), then `said` (a message of the page). What it tells: `doing` (words),
// `ready`, `said` (a message for the page), `failed`. Told to `remember`, it loads all that a page will want, and keeps
// the memory of that Python for later visits, which then need not start it.

// @ts-expect-error: it stands there when the folder is written
import { loadPyodide } from "./python/pyodide.mjs";

const KEPT = "fuzzyarm-python-";

/** The memory of a Python that was started before; null where none is kept. */
async function remembered(key) {
  if (!self.caches) return null;
  const found = await (await caches.open(KEPT + key)).match("memory");
  return found ? new Uint8Array(await found.arrayBuffer()) : null;
}

async function remember(key, memory) {
  for (const name of await caches.keys()) if (name.startsWith(KEPT) && name !== KEPT + key) await caches.delete(name);
  await (await caches.open(KEPT + key)).put("memory", new Response(memory));
}

const bytes = async (name) => {
  const answer = await fetch(name);
  if (!answer.ok) throw new Error(`${name} is missing: ${answer.status}`);
  return new Uint8Array(await answer.arrayBuffer());
};

/** Start Python, with fuzzyarm in it. */
async function started({ kernels, numpy }, options) {
  const indexURL = new URL("./python/", import.meta.url).href;
  const [python, fuzzyarm, machine, wheel] = await Promise.all([
    loadPyodide({ indexURL, ...options }),
    bytes("python/fuzzyarm.zip"),
    kernels ? bytes("python/_kernels.so") : null,
    numpy ? bytes(numpy) : null,
  ]);
  const folder = python.runPython("import sysconfig; sysconfig.get_path('purelib')");
  if (wheel) python.unpackArchive(wheel, "wheel", { extractDir: folder });
  python.unpackArchive(fuzzyarm, "zip", { extractDir: folder });
  if (machine) python.FS.writeFile(`${folder}/fuzzyarm/_kernels.so`, machine);
  return python;
}

async function begin({ files, parts, key }) {
  postMessage({ doing: "python" });
  const memory = parts.numpy ? null : await remembered(key).catch(() => null);
  const python = await started(parts, memory ? { _loadSnapshot: memory } : {});
  postMessage({ doing: "fuzzyarm" });
  const host = python.pyimport("fuzzyarm.playground.host");
  const hear = host.begin.callKwargs(python.toPy(files), (text) => postMessage({ said: text }), {
    can_load_more: true,
  });
  postMessage({ ready: true, remembered: Boolean(memory), numpy: Boolean(parts.numpy) });
  return hear;
}

async function prepare({ parts, key }) {
  if (parts.numpy || !self.caches || (await remembered(key))) return;
  const python = await started({ ...parts, kernels: false }, { _makeSnapshot: true });
  python.pyimport("fuzzyarm.playground.host").warm();
  await remember(key, python.makeMemorySnapshot());
}

let hear = null;

self.onmessage = async ({ data }) => {
  try {
    if (data.begin) hear = await begin(data.begin);
    else if (data.remember) await prepare(data.remember).finally(() => postMessage({ done: true }));
    else hear(data.said);
  } catch (error) {
    postMessage({ failed: String(error?.message ?? error) });
  }
};
