// The Python of the page, in a worker of its own: it starts Python with fuzzyarm, and hands texts to and fro.
//
// What it is told: `begin` (the files that are there), then `said` (a message of the page) and `stored` (what another tab
// has stored of a file). What it tells: `doing` (words), `ready`, `said` (a message for the page), `failed`.

import { startPython, takingOver } from "./start.js";

const answer = async (name) => {
  const found = await fetch(name);
  if (!found.ok) throw new Error(`${name} is missing: ${found.status}`);
  return found;
};
const bytes = async (name) => new Uint8Array(await (await answer(name)).arrayBuffer());
const inflated = async (name) => (await answer(name)).body.pipeThrough(new DecompressionStream("gzip"));

/** Start Python, with fuzzyarm and its machine code in it. */
async function started({ kernels, numpy, memory }) {
  const indexURL = new URL("./python/", import.meta.url).href;
  const [{ python, folder }, machine, wheel] = await Promise.all([
    startPython(
      indexURL,
      bytes("python/fuzzyarm.zip"),
      memory ? takingOver(memory, inflated("python/memory.bin")) : {},
    ),
    kernels ? bytes("python/_kernels.so") : null,
    numpy ? bytes(numpy) : null,
  ]);
  if (wheel) python.unpackArchive(wheel, "wheel", { extractDir: folder });
  if (machine) python.FS.writeFile(`${folder}/fuzzyarm/_kernels.so`, machine);
  return python;
}

async function begin({ files, parts }) {
  postMessage({ doing: "python" });
  const python = await started(parts);
  postMessage({ doing: "fuzzyarm" });
  const host = python.pyimport("fuzzyarm.apps.playground.host");
  const [hear, store] = host.begin.callKwargs(python.toPy(files), (text) => postMessage({ said: text }), {
    can_load_more: true,
  });
  postMessage({ ready: true });
  return { hear, store };
}

let begun = null;

self.onmessage = async ({ data }) => {
  try {
    begun ??= begin(data.begin);
    const { hear, store } = await begun;
    if (data.said) hear(data.said);
    else if (data.stored) store(data.stored.file, data.stored.text ?? undefined); // null would not be None
  } catch (error) {
    postMessage({ failed: String(error?.message ?? error) });
  }
};
