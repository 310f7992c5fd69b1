// Sweep: what `fuzzyarm sweep` says of the text that is open, over ranges of its gains and of the plant, with a map.

import { S } from "./strings.js";
import { noTables } from "./table.js";
import { ResultWork, showGrounds } from "./work.js";

const WIDE = 40; // letters of several ranges

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "sweep",
  title: S.sweep,
  go: S.start,
  stop: S.stopRuns,
  facts: "sweepable",
  form: () => "sweep",
  ends: S.sweepEnds,
  isEnough: true,
};

class SweepWork extends ResultWork {
  constructor(store, hand) {
    super(store, hand, KIND);
  }

  fill({ plants, gains }) {
    this.form.choices(
      "plant",
      plants.map(({ name, fits }) => [name, fits ? name : S.needsConnect(name)]),
    );
    this.form.suggest(
      "sweep",
      gains.map((gain) => `${gain}=`),
    );
    this.form.input("sweep").size = WIDE;
    this.changed("plant");
  }

  changed(name) {
    const plant = this.facts.plants.find((each) => each.name === this.form.shown("plant"));
    if (name === "plant") showGrounds(this.form, plant, [["", S.asCompared]]);
  }

  ready({ gains }) {
    return S.sweepReady(gains);
  }
}

export const SWEEP = { name: "sweep", title: S.sweep, drawn: false, further: true, why: noTables, panes: [SweepWork] };
