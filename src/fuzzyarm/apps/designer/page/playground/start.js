// How Python is started: in the worker of a page (python.js), and once where the folder is written (remember.js).
//
// A Python that has loaded fuzzyarm is a memory of 45 MB. Where the folder has it, a page takes it over and starts
// nothing anew: a tenth of the work.

// @ts-expect-error: both stand there when the folder is written
import { loadPyodide } from "./python/pyodide.mjs";
// @ts-expect-error
import createModule from "./python/pyodide.asm.mjs";

/**
 * Start Python, with the files of fuzzyarm in it.
 *
 * @param {string} indexURL where Pyodide is
 * @param {Promise<Uint8Array>} fuzzyarm its archive
 * @param {Object} options of Pyodide
 */
export async function startPython(indexURL, fuzzyarm, options) {
  const python = await loadPyodide({ indexURL, ...options });
  const folder = python.runPython("import sysconfig; sysconfig.get_path('purelib')");
  python.unpackArchive(await fuzzyarm, "zip", { extractDir: folder });
  return { python, folder };
}

/**
 * Options of a Python that takes over a memory. Its code is compiled while the memory arrives: so Pyodide is handed the
 * room for it, which is full before it looks at it. Pyodide 314 does not make its own memory as large (it used to).
 *
 * @param {number} size bytes of the memory
 * @param {Promise<ReadableStream<Uint8Array>>} arriving
 */
export function takingOver(size, arriving) {
  const room = new Uint8Array(size);
  const filled = fill(room, arriving);
  filled.catch(() => {}); // said by whoever awaits it below
  return {
    _loadSnapshot: room,
    createPyodideModule: async (settings) => {
      const module = await createModule(settings);
      await filled;
      keepTrampoline(module, room);
      if (!module.growMemory(Math.max(size, module.HEAP8.length))) throw new Error("there is no memory left");
      return module;
    },
  };
}

const MEMORY_AT = 1; // the word of the room that says where the memory begins in it

/**
 * Python calls functions in C through a function of WebAssembly that only some runtimes can have: whether this one has it,
 * and not the one that made the memory, stands in its own memory.
 */
function keepTrampoline(module, room) {
  const word = (address) => module.HEAP32[address >>> 2];
  const address = module.__PyRuntime + word(module.__PyEM_EMSCRIPTEN_TRAMPOLINE_OFFSET);
  const words = new Int32Array(room.buffer);
  words[(words[MEMORY_AT] + address) >>> 2] = word(address);
}

async function fill(room, arriving) {
  let length = 0;
  const reader = (await arriving).getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    room.set(part.value, length);
    length += part.value.length;
  }
  if (length !== room.length) throw new Error("the memory of Python is not whole");
}
