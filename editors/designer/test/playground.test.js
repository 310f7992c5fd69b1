import assert from "node:assert/strict";
import test from "node:test";
import { Kept } from "../../../src/fuzzyarm/apps/designer/page/playground/kept.js";
import { carriedBy, fragmentOf } from "../../../src/fuzzyarm/apps/designer/page/playground/link.js";
import { Tabs } from "../../../src/fuzzyarm/apps/designer/page/playground/tabs.js";

/** A browser: locks and channels of its tabs. */
function browser() {
  const channels = [];
  const queue = [];
  let holder = null;
  const grant = (act) => {
    const mine = { reject: null };
    holder = mine;
    const stolen = new Promise((_, reject) => (mine.reject = reject));
    return Promise.race([Promise.resolve(act({})), stolen]).finally(() => {
      if (holder !== mine) return;
      holder = null;
      queue.shift()?.();
    });
  };
  const request = async (_name, options, act = options) => {
    if (options.steal) {
      holder?.reject(new Error("stolen"));
      return grant(act);
    }
    if (!holder) return grant(act);
    if (options.ifAvailable) return act(null);
    return new Promise((resolve) => queue.push(() => resolve(grant(act))));
  };
  class BroadcastChannel {
    constructor() {
      channels.push(this);
    }
    postMessage(data) {
      for (const each of channels) if (each !== this) queueMicrotask(() => each.onmessage({ data }));
    }
  }
  return () => {
    const store = new Map();
    const sessionStorage = {
      getItem: (key) => store.get(key) ?? null,
      setItem: (key, value) => store.set(key, value),
      removeItem: (key) => store.delete(key),
    };
    return { BroadcastChannel, sessionStorage, navigator: { locks: { request } } };
  };
}

async function tab(host) {
  const seen = [];
  const page = {};
  for (const name of ["flush", "turned", "load"]) page[name] = () => seen.push(name);
  const tabs = new Tabs(page, host);
  await tabs.begin();
  return { tabs, seen };
}

const settled = () => new Promise((resolve) => setTimeout(resolve, 5));

test("of two tabs one writes, and hands over what it has", async () => {
  const open = browser();
  const [mine, theirs] = [open(), open()];
  const one = await tab(mine);
  const two = await tab(theirs);
  assert.deepEqual([one.tabs.writes, two.tabs.writes], [true, false]);
  two.tabs.take();
  await settled();
  assert.deepEqual(one.seen, ["flush", "turned"]); // what was typed is kept first
  assert.deepEqual(two.seen, ["load"]);
  const again = await tab(theirs); // loaded anew, it takes the lock
  await settled();
  assert.deepEqual([one.tabs.writes, again.tabs.writes], [false, true]);
});

test("without locks the tab that stored last writes", async () => {
  const { tabs, seen } = await tab({ ...browser()(), navigator: {} });
  assert.equal(tabs.writes, true);
  tabs.stored();
  assert.equal(tabs.writes, false);
  assert.deepEqual(seen, ["turned"]);
});

test("a link carries a controller and the files that it uses", async () => {
  const files = { "servo.frb": 'use table1 from "pd7.frb" # "no.frb"\n', "pd7.frb": "# é\n" };
  assert.deepEqual(await carriedBy(await fragmentOf(files)), files);
  assert.equal(await carriedBy("#file=servo.frb"), null);
  await assert.rejects(carriedBy(await fragmentOf({ "../x.frb": "" })));
  await assert.rejects(carriedBy(await fragmentOf({})));
});

test("what a link brings replaces no text, and uses its own files", () => {
  const kept = new Kept();
  kept.put("pd7.frb", "mine");
  const files = {
    "servo.frb": 'use u from "pd7.frb"  # "pd7.frb"\nuse v from "v.frb"\n',
    "pd7.frb": "theirs",
    "v.frb": "",
  };
  const found = kept.bring(files);
  assert.deepEqual(found, { name: "servo.frb", renamed: [["pd7.frb", "pd7-2.frb"]], isKept: true });
  assert.equal(kept.get("pd7.frb"), "mine");
  assert.equal(kept.get("pd7-2.frb"), "theirs");
  assert.equal(kept.get("servo.frb"), 'use u from "pd7-2.frb"  # "pd7.frb"\nuse v from "v.frb"\n');
  assert.deepEqual(kept.bring(files).name, "servo.frb"); // it is here already
});

test("a page forgets only what it has offered itself", () => {
  const kept = new Kept();
  kept.put("mine.frb", "");
  kept.put("theirs.frb", "");
  kept.offer(["mine.frb"]);
  kept.offer([]);
  assert.deepEqual(kept.names(), ["theirs.frb"]);
});
