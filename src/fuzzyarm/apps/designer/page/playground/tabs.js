// Which of several tabs writes a file that the browser keeps: one of them; the others read it, and say so.
//
// The one that writes a file holds its lock. Where a page may have none (http from another machine), the tab that wrote it
// last writes it, and the others hear of it by what they find stored.

const NAME = "fuzzyarm playground: ";
const PATIENCE = 2000; // ms that the tab that writes has to answer

export class Tabs {
  /**
   * @param {{ kept(file: string): string, turned(file: string, text?: string): void }} page
   *   keeps what is typed, and gives it; hears of a change, with the text where a tab has handed it over
   * @param {any} host where locks and channels are
   */
  constructor(page, host = globalThis) {
    this.page = page;
    this.locks = host.navigator?.locks;
    this.claims = new Map(); // by file that is open here: how its lock is let go, and how it is not waited for any more
    this.others = new Set(); // files that another tab writes
    if (!this.locks) return;
    this.channel = new host.BroadcastChannel(NAME);
    this.channel.onmessage = ({ data }) => this.hear(data);
  }

  writes = (file) => !this.others.has(file);

  /** Write a file that is opened, where no other tab does; else as soon as none does. */
  async open(file) {
    if (!this.locks || this.claims.has(file)) return;
    const claim = { steals: false, late: 0, text: undefined, release: () => {}, hurry: () => {} };
    this.claims.set(file, claim);
    const isOpen = () => this.claims.get(file) === claim;
    /** @type {LockOptions} */
    let how = { ifAvailable: true };
    while (isOpen()) {
      const held = (lock) => {
        if (!isOpen()) return null;
        this.turn(file, Boolean(lock));
        return lock && new Promise((done) => (claim.release = () => done(null)));
      };
      // It is taken by another tab, or not waited for any more.
      await this.locks.request(NAME + file, how, held).catch(() => isOpen() && this.turn(file, false));
      const waiting = new AbortController();
      claim.hurry = () => waiting.abort();
      how = claim.steals ? { steal: true } : { signal: waiting.signal };
      claim.steals = false;
    }
  }

  close(file) {
    const claim = this.claims.get(file);
    this.claims.delete(file);
    this.others.delete(file);
    claim?.release();
    claim?.hurry();
  }

  /** Whether no other tab writes a file. */
  isFree = async (file) =>
    this.claims.has(file) || !this.locks
      ? this.writes(file)
      : this.locks.request(NAME + file, { ifAvailable: true }, (lock) => Boolean(lock));

  /** Another tab has stored a file: without locks it writes it from now on. */
  stored(file) {
    if (!this.locks) this.turn(file, false);
  }

  /** Write a file here: the tab that writes it keeps what it has, and then reads. */
  take(file) {
    if (!this.locks) return this.turn(file, true);
    this.channel.postMessage({ file, do: "give" });
    this.claims.get(file).late = setTimeout(() => this.hear({ file, do: "given", text: undefined }), PATIENCE);
  }

  hear({ file, do: said, text }) {
    const claim = this.claims.get(file);
    if (!claim) return;
    if (said === "give" && this.writes(file)) {
      const given = this.page.kept(file);
      this.turn(file, false);
      this.channel.postMessage({ file, do: "given", text: given });
      claim.release();
    } else if (said === "given" && claim.late) {
      clearTimeout(claim.late);
      claim.text = text;
      claim.late = 0;
      claim.steals = !this.writes(file);
      claim.hurry();
    }
  }

  turn(file, writes) {
    if (this.writes(file) === writes) return;
    if (writes) this.others.delete(file);
    else this.others.add(file);
    const claim = this.claims.get(file);
    this.page.turned(file, writes ? claim?.text : undefined);
    if (claim) claim.text = undefined;
  }
}
