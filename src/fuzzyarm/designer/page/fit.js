// Fit: what `fuzzyarm fit` makes of samples in the folder, with residuals, calibration and the firing of the rules.

import { S } from "./strings.js";
import { pairOf, WorkPane } from "./work.js";

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "fit",
  title: S.fit,
  go: S.fitIt,
  facts: "fittable",
  ends: S.fitEnds,
  enough: S.stopAndKeep,
  saves: true,
  form: () => "fit",
  fill(form, { samples, models }) {
    form.choices("data", [...samples, ...models].map(pairOf));
    form.choices("test", [["", S.none], ...samples.map(pairOf)]);
  },
  ready: ({ samples }) => (samples.length ? S.fitReady : S.noSamples),
};

const fitPane = (store, hand) => new WorkPane(store, hand, KIND).section;

export const FIT = { name: "fit", title: S.fit, drawn: false, panes: [fitPane] };
