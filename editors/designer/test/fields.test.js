import assert from "node:assert/strict";
import { test } from "node:test";

import {
  choicesOf,
  controlOf,
  optionsOf,
  quoted,
  shownDefault,
  valueOf,
} from "../../../src/fuzzyarm/apps/designer/page/fields.js";

const WORDS = { usual: "usual", yes: "yes", no: "no" };
const LIST = { type: "array", items: { type: "string" }, default: [] };
/** @type {Record<string, Messages.FormField>} */
const FIELDS = {
  evals: { name: "evals", option: "--evals", type: "integer", default: 500, placeholder: "N" },
  noise: { name: "noise", option: "--noise", placeholder: "PORT=DEVIATION", repeated: true, ...LIST },
  loaded: { name: "loaded", option: "--loaded", placeholder: "N", ...LIST },
  tune: { name: "tune", option: "--tune", placeholder: "LINE", repeated: true, ...LIST },
  payload: { name: "payload", option: "--payload", type: ["boolean", "null"], default: null },
  linear: { name: "linear", option: "--linear", type: "boolean", default: true, negatable: true },
  mode: { name: "mode", option: "--mode", type: ["string", "null"], enum: ["bins", "linear", null], default: null },
  file: { name: "file", option: "", type: "string" },
};

test("the control of a field follows from its schema", () => {
  const controls = Object.entries(FIELDS).map(([name, field]) => `${name} ${controlOf(field)}`);
  assert.deepEqual(controls, [
    "evals text",
    "noise text",
    "loaded text",
    "tune lines",
    "payload choice",
    "linear check",
    "mode choice",
    "file text",
  ]);
});

test("where null is a value, a choice begins with the usual", () => {
  assert.deepEqual(choicesOf(FIELDS.mode, WORDS), [
    ["", "usual"],
    ["bins", "bins"],
    ["linear", "linear"],
  ]);
  assert.deepEqual(choicesOf(FIELDS.payload, WORDS), [
    ["", "usual"],
    ["true", "yes"],
    ["false", "no"],
  ]);
});

test("what is shown by default says what the default says", () => {
  for (const [name, field] of Object.entries(FIELDS)) {
    const value = valueOf(field, shownDefault(field));
    assert.deepEqual(optionsOf([field], { [name]: value }), [], name);
  }
});

test("values are lists, truths, or the text that was typed", () => {
  assert.equal(valueOf(FIELDS.evals, " 1.5x "), "1.5x"); // Python says what is wrong with it
  assert.deepEqual(valueOf(FIELDS.noise, " a=1   b=2 "), ["a=1", "b=2"]);
  assert.deepEqual(valueOf(FIELDS.tune, "peaks e\n\n gain G 1 .. 2 \n"), ["peaks e", "gain G 1 .. 2"]);
  assert.equal(valueOf(FIELDS.payload, ""), null);
  assert.equal(valueOf(FIELDS.payload, "false"), false);
  assert.equal(valueOf(FIELDS.linear, false), false);
});

test("the words of a command are those that differ from it", () => {
  const values = {
    evals: "90",
    noise: ["a=1", "b=2"],
    loaded: ["1", "2"],
    payload: false,
    linear: false,
    mode: "bins",
    file: "x.frb",
  };
  assert.equal(
    optionsOf(Object.values(FIELDS), values).join(" "),
    "--evals 90 --noise a=1 --noise b=2 --loaded 1 2 --no-payload --no-linear --mode bins",
  );
});

test("words that a shell would take apart are quoted", () => {
  assert.deepEqual(["a=1", "it's", "a b"].map(quoted), ["a=1", "'it'\\''s'", "'a b'"]);
});

test("the log of a range belongs to it", () => {
  const field = /** @type {any} */ ({
    name: "sweep",
    type: "array",
    items: { type: "string" },
    placeholder: "NAME=A..B:N",
  });
  assert.deepEqual(valueOf(field, " G_e=2..60:12 log  J=1..2:3 "), ["G_e=2..60:12 log", "J=1..2:3"]);
});
