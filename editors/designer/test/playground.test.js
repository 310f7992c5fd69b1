import assert from "node:assert/strict";
import test from "node:test";
import { Kept } from "../../../src/fuzzyarm/apps/designer/page/playground/kept.js";
import { carriedBy, fragmentOf } from "../../../src/fuzzyarm/apps/designer/page/playground/link.js";
import { Tabs } from "../../../src/fuzzyarm/apps/designer/page/playground/tabs.js";

/** A browser: locks and channels of its tabs. */
function browser() {
  const channels = [];
  const locks = new Map(); // by name: who holds it, and who waits
  const lockOf = (name) => locks.get(name) ?? locks.set(name, { holder: null, queue: [] }).get(name);
  const grant = (lock, act) => {
    const mine = { reject: null };
    lock.holder = mine;
    const stolen = new Promise((_, reject) => (mine.reject = reject));
    return Promise.race([Promise.resolve(act({})), stolen]).finally(() => {
      if (lock.holder !== mine) return;
      lock.holder = null;
      lock.queue.shift()?.();
    });
  };
  const request = async (name, options, act) => {
    const lock = lockOf(name);
    if (options.steal) {
      lock.holder?.reject(new Error("stolen"));
      return grant(lock, act);
    }
    if (!lock.holder) return grant(lock, act);
    if (options.ifAvailable) return act(null);
    return new Promise((resolve, reject) => {
      const begin = () => resolve(grant(lock, act));
      lock.queue.push(begin);
      options.signal.onabort = () => {
        if (!lock.queue.includes(begin)) return;
        lock.queue.splice(lock.queue.indexOf(begin), 1);
        reject(new Error("aborted"));
      };
    });
  };
  class BroadcastChannel {
    constructor() {
      channels.push(this);
    }
    postMessage(data) {
      for (const each of channels) if (each !== this) queueMicrotask(() => each.onmessage({ data }));
    }
  }
  return { BroadcastChannel, navigator: { locks: { request } } };
}

const settled = () => new Promise((resolve) => setTimeout(resolve, 5));

async function tab(host, ...files) {
  const seen = [];
  const tabs = new Tabs(
    {
      kept: (file) => `text of ${file}`,
      turned: (file, text = "") => seen.push(`${file} ${tabs.writes(file) ? "writes" : "reads"} ${text}`.trim()),
    },
    host,
  );
  for (const file of files) tabs.open(file);
  await settled();
  return { tabs, seen };
}

test("tabs on different files both write; of those on one file one does", async () => {
  const host = browser();
  const one = await tab(host, "a", "b");
  const two = await tab(host, "b", "c");
  assert.deepEqual(["a", "b"].map(one.tabs.writes), [true, true]);
  assert.deepEqual(["b", "c"].map(two.tabs.writes), [false, true]);
  assert.equal(await two.tabs.isFree("a"), false); // not open there
  assert.equal(await two.tabs.isFree("d"), true);
  one.tabs.close("b");
  await settled();
  assert.equal(two.tabs.writes("b"), true);
  assert.deepEqual(two.seen, ["b reads", "b writes"]);
});

test("a tab hands over a file with all that it has, to the one that asks and not to one that waits", async () => {
  const host = browser();
  const [one, two, three] = [await tab(host, "a"), await tab(host, "a"), await tab(host, "a")];
  three.tabs.take("a");
  await settled();
  assert.deepEqual([one.seen, three.seen], [["a reads"], ["a reads", "a writes text of a"]]);
  assert.deepEqual(
    [one, two, three].map(({ tabs }) => tabs.writes("a")),
    [false, false, true],
  );
  three.tabs.close("a");
  await settled();
  assert.equal([one, two].filter(({ tabs }) => tabs.writes("a")).length, 1);
});

test("without locks the tab that stored a file last writes it", async () => {
  const { tabs, seen } = await tab({}, "a", "b");
  tabs.stored("a");
  assert.deepEqual(["a", "b"].map(tabs.writes), [false, true]);
  tabs.take("a");
  assert.deepEqual(seen, ["a reads", "a writes"]);
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
