// The memory of a Python that has loaded all that a page will want; run by node where the folder is written, as
//
//   node remember.js python/ python/memory

// @ts-expect-error: types of node are not those of a page
import { readFile, writeFile } from "node:fs/promises";
// @ts-expect-error
import { argv } from "node:process";
import { startPython } from "./start.js";

// When it starts, Python asks whether WebAssembly can wait for JavaScript, and never again. Not every node can, and here
// nothing waits; a browser that takes the memory over still says itself whether it can (can_run_sync).
const wasm = /** @type {any} */ (WebAssembly);
wasm.Suspending ??= function (act) {
  return act;
};
wasm.promising ??= (act) => act;

const [folder, written] = argv.slice(2);
const archive = readFile(`${folder}fuzzyarm.zip`).then((content) => new Uint8Array(content));
const { python } = await startPython(folder, archive, { _makeSnapshot: true });
python.pyimport("fuzzyarm.apps.playground.host").warm();
await writeFile(written, python.makeMemorySnapshot());
