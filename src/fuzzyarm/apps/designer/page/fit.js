// Fit: what `fuzzyarm fit` makes of samples in the folder, with residuals, calibration and the firing of the rules.

import { el, pairsOf } from "./draw.js";
import { S } from "./strings.js";
import { ResultWork } from "./work.js";

/** @type {import("./work.js").Kind} */
const KIND = {
  name: "fit",
  title: S.fit,
  go: S.fit,
  stop: S.stopAndKeep,
  facts: "fittable",
  form: () => "fit",
  ends: S.fitEnds,
  isEnough: true,
  ofFolder: true,
};

class FitWork extends ResultWork {
  constructor(store, hand) {
    super(store, hand, KIND);
    this.saving("", S.save);
    this.isFirst = false; // whether samples have just been put into the folder
    this.example = el("button", { textContent: S.valveSamples, hidden: true, onclick: () => this.bringSamples() });
    this.start.after(this.example);
  }

  /** Put samples to learn from into the folder. */
  async bringSamples() {
    const { error } = await this.hand.folder({ what: "samples" });
    if (error) return this.say(error);
    this.stale = this.isFirst = true;
    return this.ask();
  }

  fill({ samples, models }) {
    this.example.hidden = samples.length > 0;
    this.form.choices("data", pairsOf([...samples, ...models]));
    this.form.choices("test", [["", S.none], ...pairsOf(samples)]);
    if (this.isFirst) this.form.set("test", samples[1] ?? ""); // the others that came with them
    this.isFirst = false;
  }

  ready({ samples }) {
    return samples.length ? S.fitReady : S.noSamples;
  }

  take(news) {
    super.take(news);
    if (!news.name) return;
    this.isOver = true; // it waits, and can be written
    this.name.value = news.name;
    this.say(S.fitEnds.done);
  }
}

export const FIT = { name: "fit", title: S.fit, drawn: false, further: true, panes: [FitWork] };
