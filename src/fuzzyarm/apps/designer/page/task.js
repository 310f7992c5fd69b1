// One piece of long work at a time: of several that were begun only the last is heard.

export class Task {
  /**
   * @param {Pick<Page.Hand, "start" | "settled" | "gone">} hand
   * @param {keyof Messages.Works} what
   */
  constructor(hand, what) {
    this.hand = hand;
    this.what = what;
    /** @type {Page.Job | null} */
    this.job = null;
    this.round = 0;
    this.waits = null; // hears of what has not begun yet
  }

  get isBegun() {
    return Boolean(this.job ?? this.waits);
  }

  /** Begin it; what went on before is stopped, and says no more. */
  begin(asked, hear) {
    this.drop();
    const mine = this.round;
    this.job = this.hand.start(this.what, asked, (news) => {
      if (mine !== this.round) return; // an older one may still speak
      if (news.end) this.job = null;
      hear(news);
    });
  }

  /** Begin it once the server has what is typed; `asked` says what is asked for then. */
  async beginSettled(asked, hear) {
    this.drop();
    const mine = this.round;
    this.waits = hear;
    const isThere = await this.hand.settled();
    if (mine !== this.round) return;
    this.waits = null;
    if (isThere) this.begin(asked(), hear);
    else hear({ end: "failed", message: this.hand.gone() });
  }

  say(words) {
    this.job?.say(words);
  }

  /** Stop it; its end is still heard. */
  stop() {
    const hear = this.waits;
    this.job?.stop();
    if (!hear) return;
    this.drop();
    hear({ end: "stopped" });
  }

  /** Stop it, and hear no more of it. */
  drop() {
    this.round++;
    this.job?.stop();
    this.job = null;
    this.waits = null;
  }
}
