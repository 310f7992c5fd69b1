// Sweep: what `fuzzyarm sweep` says of the text that is open, over ranges of its gains and of the plant, with a map.

import { S } from "./strings.js";
import { showGrounds, WorkPane } from "./work.js";

const WIDE = 40; // letters of several ranges

const plantOf = (form, { plants }) => plants.find((each) => each.name === form.shown("plant"));

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "sweep",
  title: S.sweep,
  go: S.start,
  facts: "sweepable",
  ends: S.sweepEnds,
  form: () => "sweep",
  fill(form, facts) {
    const words = facts.plants.map(({ name, fits }) => [name, fits ? name : S.needsConnect(name)]);
    form.choices("plant", words);
    form.suggest(
      "sweep",
      facts.gains.map((gain) => `${gain}=`),
    );
    form.input("sweep").size = WIDE;
    showGrounds(form, plantOf(form, facts), [["", S.asCompared]]);
  },
  changed(form, facts, name) {
    if (name === "plant") showGrounds(form, plantOf(form, facts), [["", S.asCompared]]);
  },
  ready: ({ gains }) => S.sweepReady(gains),
};

const sweepPane = (store, hand) => new WorkPane(store, hand, KIND).section;

export const SWEEP = { name: "sweep", title: S.sweep, drawn: false, panes: [sweepPane] };
