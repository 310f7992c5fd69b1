// Texts that stay in the browser: each under a name of its own, from one visit to the next.

const PREFIX = "fuzzyarm playground: ";
const BEGUN = "fuzzyarm playground"; // whether somebody has been here before

/** The texts of a browser that keeps none: they last as long as the page. */
class Passing {
  constructor() {
    this.all = new Map();
  }

  getItem = (key) => this.all.get(key) ?? null;

  setItem = (key, value) => void this.all.set(key, value);

  removeItem = (key) => void this.all.delete(key);

  keys = () => [...this.all.keys()];
}

function store() {
  try {
    localStorage.setItem(PREFIX, "");
    localStorage.removeItem(PREFIX);
    return {
      getItem: (key) => localStorage.getItem(key),
      setItem: (key, value) => localStorage.setItem(key, value),
      removeItem: (key) => localStorage.removeItem(key),
      keys: () => Object.keys(localStorage),
    };
  } catch {
    return new Passing(); // it is forbidden, or full
  }
}

/** Texts by the names of their files. */
export class Kept {
  constructor() {
    this.store = store();
    /** Whether they outlast the page. */
    this.lasting = !(this.store instanceof Passing);
    this.begun = new Set(); // names that this page has offered
  }

  /** Put files there for somebody who has not been here before. */
  begin(texts) {
    if (this.store.getItem(BEGUN) !== null) return;
    for (const [name, text] of Object.entries(texts)) if (this.get(name) === null) this.put(name, text);
    this.store.setItem(BEGUN, "");
  }

  /** The file whose text is stored under a key; empty where none is. */
  nameOf = (key) => (key.startsWith(PREFIX) ? key.slice(PREFIX.length) : "");

  names = () => this.store.keys().map(this.nameOf).filter(Boolean).sort();

  /** @returns {string | null} */
  get(name) {
    return this.store.getItem(PREFIX + name);
  }

  /** Keep a text; whether there was room for it. */
  put(name, text) {
    try {
      this.store.setItem(PREFIX + name, text);
      return true;
    } catch {
      return false;
    }
  }

  remove(name) {
    this.store.removeItem(PREFIX + name);
  }

  /** Forget the texts that this page has offered and does not offer any more; those of another tab stay. */
  offer(names) {
    for (const name of this.begun) if (!names.includes(name)) this.remove(name);
    this.begun = new Set(names);
  }

  /**
   * Take files that belong together, of which the first uses the others. No text is replaced: where a name has another
   * text, the file gets a free name, and its users name that.
   *
   * @param {Record<string, string>} files
   * @returns {{ name: string, renamed: Array<[string, string]>, isKept: boolean }}
   */
  bring(files) {
    const [first, ...others] = Object.keys(files);
    const names = new Map();
    const put = (name, text) => {
      names.set(name, this.free(name, text));
      return this.put(names.get(name), text);
    };
    let isKept = true;
    for (const name of others) isKept = put(name, files[name]) && isKept;
    const named = (line) => line.replace(/"([^"]*)"/g, (all, name) => (names.has(name) ? `"${names.get(name)}"` : all));
    isKept = put(first, files[first].replace(/^use\s[^#\n]*/gm, named)) && isKept;
    return { name: names.get(first), renamed: [...names].filter(([old, now]) => old !== now), isKept };
  }

  all() {
    return Object.fromEntries(this.names().map((name) => [name, this.get(name)]));
  }

  /** A name that is free, or that has this text already. */
  free(name, text) {
    const at = name.lastIndexOf(".");
    for (let k = 1; ; k++) {
      const tried = k === 1 ? name : `${name.slice(0, at)}-${k}${name.slice(at)}`;
      const there = this.get(tried);
      if (there === null || there === text) return tried;
    }
  }
}
