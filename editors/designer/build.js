// Builds what the page takes from a bundle, into files that are committed: after `pip install` there is no node.
//
//   page/vendor/codemirror.js   the editor, from the packages pinned here
//   page/vendor/uplot.js, .css  charts over time, likewise
//   page/built/playground.js    the page with its own Python (playground/app.js), as one script
//
// `node build.js --check` writes nothing and fails where a file is not what its sources say. The modules of the
// page with a server are served as they are: from this machine they are there at once, and a trace names their lines.
import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const at = (path) => fileURLToPath(new URL(path, import.meta.url));
const PAGE = "../../src/fuzzyarm/apps/designer/page";

/** The engine is printed from the kernel when a page is made: its script stands in front of the bundle. */
const engineInFront = {
  name: "engine in front",
  setup(bundle) {
    bundle.onResolve({ filter: /^\.\/engine\.js$/ }, () => ({ path: "engine", namespace: "front" }));
    bundle.onLoad({ filter: /.*/, namespace: "front" }, () => ({
      contents: "export const { Engine } = globalThis.fuzzyarm;",
    }));
  },
};

const COMMON = { bundle: true, format: "esm", target: "es2022", legalComments: "none", write: false };
const BUILDS = [
  {
    entryPoints: [at("codemirror.js")],
    outfile: at(`${PAGE}/vendor/codemirror.js`),
    banner: { js: "// @ts-nocheck" },
    minify: true,
  },
  {
    entryPoints: [at("uplot.js")],
    outfile: at(`${PAGE}/vendor/uplot.js`),
    banner: { js: "// @ts-nocheck" },
    minify: true,
  },
  { entryPoints: [at("node_modules/uplot/dist/uPlot.min.css")], outfile: at(`${PAGE}/vendor/uplot.css`), minify: true },
  {
    entryPoints: [at(`${PAGE}/playground/app.js`)],
    outfile: at(`${PAGE}/built/playground.js`),
    banner: { js: "// @ts-nocheck: built by editors/designer/build.js from playground/app.js and what it imports" },
    plugins: [engineInFront],
    format: "iife", // no name of it meets one of the engine
    minify: true,
    absWorkingDir: at(PAGE),
  },
];

const check = process.argv.includes("--check");
for (const options of BUILDS) {
  const { outputFiles } = await build({ ...COMMON, ...options });
  const { path, text } = outputFiles[0];
  const before = await readFile(path, "utf8").catch(() => "");
  if (before === text) continue;
  if (check) {
    console.error(`${path} is not what its sources say: make designer`);
    process.exitCode = 1;
  } else await writeFile(path, text);
}
