// Prove: what `fuzzyarm prove` says of the text that is open, with the region or the tube of a loop as a picture.
// Margins: what `fuzzyarm margins` says of its loop, with Bode and Nyquist diagrams.

import { el, pairsOf } from "./draw.js";
import { S } from "./strings.js";
import { ResultWork } from "./work.js";

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "prove",
  title: S.prove,
  go: S.prove,
  facts: "provable",
  form: ({ loop }) => (loop ? "prove-loop" : "prove"),
  ends: S.proveEnds,
};

class ProveWork extends ResultWork {
  constructor(store, hand) {
    super(store, hand, KIND);
    this.certificate = el("input", { type: "checkbox" });
    this.option = el(
      "label",
      { class: "check", title: S.certificateHint, hidden: true },
      this.certificate,
      S.certificate,
    );
    this.actions.append(this.option);
  }

  fill({ loop, outputs, plants, tables }) {
    this.option.hidden = !loop;
    this.certificate.checked &&= loop;
    this.form.choices("output", pairsOf(outputs));
    this.form.choices("table", [["", S.none], ...pairsOf(tables)]);
    this.form.choices("plant", [["", S.usual], ...pairsOf(plants)]);
    this.form.show(["output"], outputs.length > 1);
  }

  ready({ lines }) {
    return S.proveLines(lines);
  }

  begin() {
    super.begin(this.certificate.checked ? { certificate: true } : {});
  }
}

export const PROVE = { name: "prove", title: S.prove, drawn: false, further: true, panes: [ProveWork] };

/** @type {import("./work.js").Kind} */
const MARGINS_KIND = {
  name: "margins",
  title: S.margins,
  go: S.start,
  facts: "opened-loop",
  form: () => "margins",
  ends: S.marginsEnds,
};

class MarginsWork extends ResultWork {
  constructor(store, hand) {
    super(store, hand, MARGINS_KIND);
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
