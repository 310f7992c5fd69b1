import assert from "node:assert/strict";
import test from "node:test";
import { groupsOf } from "../../../src/fuzzyarm/apps/designer/page/exports.js";

test("every file that the server offers has its place, a new one among the programs", () => {
  const offered = [".h", ".c", ".st", ".xml", ".lut", ".svg", ".fis", ".new"];
  const groups = groupsOf(offered);
  assert.deepEqual(groups.flatMap(([, suffixes]) => suffixes).sort(), [...offered].sort());
  assert.deepEqual(Object.fromEntries(groups).programs, [".h", ".c", ".st", ".xml", ".new"]);
  assert.deepEqual(Object.fromEntries(groups).others, [".fis"]);
});

test("a group without files is not shown", () => assert.deepEqual(groupsOf([".png"]), [["pictures", [".png"]]]));
