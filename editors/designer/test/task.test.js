import assert from "node:assert/strict";
import test from "node:test";
import { Task } from "../../../src/fuzzyarm/apps/designer/page/task.js";

/** A hand whose works speak when the test says so. */
function held(settled = async () => true) {
  const works = [];
  const start = (what, asked, hear) => {
    const work = { what, asked, hear, said: [], isStopped: false };
    works.push(work);
    return { say: (words) => work.said.push(words), stop: () => (work.isStopped = true) };
  };
  return { works, task: new Task({ start, settled, gone: () => "it does not answer" }, "compare") };
}

test("of two works only the last is heard, in whatever order they answer", () => {
  const { works, task } = held();
  const heard = [];
  task.begin({ other: "a" }, (news) => heard.push(["a", news]));
  task.begin({ other: "b" }, (news) => heard.push(["b", news]));
  assert.deepEqual(
    works.map((work) => work.isStopped),
    [true, false],
  );
  works[1].hear({ end: "done" });
  works[0].hear({ outputs: ["y"] }); // late, when nothing else goes on
  works[0].hear({ end: "stopped" });
  assert.deepEqual(heard, [["b", { end: "done" }]]);
  assert.equal(task.job, null);
});

test("two that wait for the text begin once", async () => {
  const waiting = [];
  const { works, task } = held(() => new Promise((resolve) => waiting.push(resolve)));
  const begun = ["a", "b"].map((other) =>
    task.beginSettled(
      () => ({ other }),
      () => {},
    ),
  );
  waiting.forEach((resolve) => resolve(true));
  await Promise.all(begun);
  assert.deepEqual(
    works.map((work) => work.asked.other),
    ["b"],
  );
});

test("what is dropped while it waits for the text does not begin", async () => {
  let arrive;
  const { works, task } = held(() => new Promise((resolve) => (arrive = resolve)));
  const begun = task.beginSettled(
    () => ({}),
    () => assert.fail("heard"),
  );
  task.drop();
  arrive(true);
  await begun;
  assert.equal(works.length, 0);
});

test("what is stopped while it waits for the text has its end", async () => {
  let arrive;
  const heard = [];
  const { works, task } = held(() => new Promise((resolve) => (arrive = resolve)));
  const begun = task.beginSettled(
    () => ({}),
    (news) => heard.push(news),
  );
  task.stop();
  arrive(true);
  await begun;
  assert.equal(works.length, 0);
  assert.deepEqual(heard, [{ end: "stopped" }]);
});

test("without a server it fails in words", async () => {
  const { works, task } = held(async () => false);
  const heard = [];
  await task.beginSettled(
    () => ({}),
    (news) => heard.push(news),
  );
  assert.equal(works.length, 0);
  assert.equal(heard[0].end, "failed");
  assert.match(heard[0].message, /does not answer/);
});

test("the end of what is stopped is heard", () => {
  const { works, task } = held();
  const heard = [];
  task.begin({}, (news) => heard.push(news.end));
  task.stop();
  works[0].hear({ end: "stopped" });
  assert.deepEqual(heard, ["stopped"]);
});
