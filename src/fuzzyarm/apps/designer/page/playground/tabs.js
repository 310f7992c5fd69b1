// Which of several tabs writes what the browser keeps: one of them; the others read, and say so.
//
// The one that writes holds a lock. Where a page may have none (http from another machine), the tab that wrote last
// writes, and the others hear of it by what they find stored.

const NAME = "fuzzyarm playground";
const TAKES = "fuzzyarm playground: takes"; // in the session of a tab that is loaded anew to write
const PATIENCE = 2000; // ms that the tab that writes has to answer

export class Tabs {
  /**
   * @param {{ flush(): void, turned(): void, load(): void }} page keeps what is typed, hears of a change, is loaded anew
   * @param {any} host where locks and channels are
   */
  constructor(page, host = globalThis) {
    this.page = page;
    this.host = host;
    this.writes = true;
  }

  /** Become the tab that writes, where none does; else read until that one has gone. */
  async begin() {
    const { BroadcastChannel, sessionStorage, navigator } = this.host;
    this.locks = navigator.locks;
    if (!this.locks) return;
    this.channel = new BroadcastChannel(NAME);
    this.channel.onmessage = ({ data }) => this.hear(data);
    const steal = sessionStorage.getItem(TAKES) !== null;
    sessionStorage.removeItem(TAKES);
    await new Promise((known) => {
      const held = (lock) => {
        this.writes = Boolean(lock);
        known();
        return lock && new Promise(() => {}); // as long as the tab is there
      };
      const asked = this.locks.request(NAME, steal ? { steal } : { ifAvailable: true }, held);
      asked.catch(() => this.lose());
    });
    if (!this.writes) this.wait();
  }

  /** Another tab has stored something: without locks it writes from now on. */
  stored() {
    if (!this.locks) this.turn(false);
  }

  /** Write here: the tab that writes keeps what it has, and then reads. */
  take() {
    if (!this.locks) return this.page.load();
    this.taking = true;
    this.channel.postMessage("give");
    this.late = setTimeout(() => this.hear("given"), PATIENCE);
  }

  hear(said) {
    if (said === "give" && this.writes) {
      this.page.flush();
      this.turn(false);
      this.channel.postMessage("given");
    } else if (said === "given" && this.taking) {
      clearTimeout(this.late);
      this.taking = false;
      this.host.sessionStorage.setItem(TAKES, "");
      this.page.load();
    }
  }

  lose() {
    this.turn(false);
    this.wait();
  }

  /** When the tab that writes has gone, this one is loaded anew, with what that one has stored. */
  wait() {
    this.locks.request(NAME, () => this.page.load()).catch(() => null);
  }

  turn(writes) {
    if (this.writes === writes) return;
    this.writes = writes;
    this.page.turned();
  }
}
