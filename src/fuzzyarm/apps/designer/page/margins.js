// Margins: what `fuzzyarm margins` says of the loop that is open, with Bode and Nyquist diagrams.

import { pairsOf } from "./draw.js";
import { S } from "./strings.js";
import { ResultWork } from "./work.js";

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "margins",
  title: S.margins,
  go: S.start,
  facts: "opened-loop",
  form: () => "margins",
  ends: S.marginsEnds,
};

class MarginsWork extends ResultWork {
  constructor(store, hand) {
    super(store, hand, KIND);
  }

  fill({ plants }) {
    this.form.choices("plant", [
      ["", S.usual],
      ...pairsOf(plants.filter((each) => each.fits).map((each) => each.name)),
    ]);
  }

  ready() {
    return S.marginsReady;
  }
}

export const MARGINS = {
  name: "margins",
  title: S.margins,
  drawn: false,
  further: true,
  why: (_hand, { asDiagram }) => (asDiagram ? "" : S.noMargins),
  panes: [MarginsWork],
};
