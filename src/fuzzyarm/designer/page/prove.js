// Prove: what `fuzzyarm prove` says of the text that is open, with the region or the tube of a loop as a picture.

import { S } from "./strings.js";
import { pairOf, WorkPane } from "./work.js";

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "prove",
  title: S.prove,
  go: S.proveIt,
  facts: "provable",
  ends: S.proveEnds,
  form: ({ loop }) => (loop ? "prove-loop" : "prove"),
  options: { certificate: [S.certificate, S.certificateHint] },
  fill(form, { loop, outputs, plants, tables }, boxes) {
    const box = boxes.get("certificate");
    box.parentElement.hidden = !loop;
    box.checked &&= loop;
    form.choices("output", outputs.map(pairOf));
    form.choices("table", [["", S.none], ...tables.map(pairOf)]);
    form.choices("plant", [["", S.usual], ...plants.map(pairOf)]);
    form.show(["output"], outputs.length > 1);
  },
  ready: ({ lines }) => S.proveLines(lines),
};

const provePane = (store, hand) => new WorkPane(store, hand, KIND).section;

export const PROVE = { name: "prove", title: S.prove, drawn: false, panes: [provePane] };
