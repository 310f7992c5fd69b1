// Variables: the line above the plot of each, and the dialogs that add, stretch, rename and remove them.

import { el, readNumber, shortNumber, space } from "./draw.js";
import { S } from "./strings.js";
import { rangeOf, sendable } from "./geometry/shapes.js";

/** Numbers of a range as a person types them; null where they are not numbers. */
export function readEnds(low, high) {
  const ends = [low, high].map((text) => Number(String(text).trim().replace("inf", "Infinity") || NaN));
  return ends.some(Number.isNaN) ? null : ends;
}

/** Names between blanks or commas; one with blanks stands in quotes. */
export function readNames(text) {
  return (text.match(/'[^']*'|"[^"]*"|[^\s,]+/g) ?? []).map((name) => name.replace(/^(['"])(.*)\1$/, "$2"));
}

const said = (x) => (x === null ? "inf" : shortNumber(x, 12));

/** The ends of a range as they stand in a text. */
export const endsWords = ({ low, high }) => `${low === null ? "-inf" : said(low)} .. ${said(high)}`;

/** Ask for a variable and add it; `attempt` makes the edit and answers. */
export function addVariable({ fill, attempt }, role) {
  return fill(
    S.addRole[role],
    [
      { name: "variable", label: S.name, value: "" },
      { name: "low", label: S.lowEnd, value: role === "input" ? "-1" : "0" },
      { name: "high", label: S.highEnd, value: "1" },
      { name: "terms", label: S.namesOfTerms, value: S.threeTerms },
    ],
    S.add,
    ({ variable, low, high, terms }) => {
      const ends = readEnds(low, high);
      if (!ends) return { error: S.notARange(low, high) };
      return attempt("variable", {
        role,
        variable: variable.trim(),
        low: sendable(ends[0]),
        high: sendable(ends[1]),
        terms: readNames(terms),
      });
    },
    S.addVariableNote,
  );
}

function stretch({ fill, attempt }, variable) {
  const [low, high] = endsWords(variable).split(" .. ");
  return fill(
    S.rangeOf(variable.name),
    [
      { name: "low", label: S.lowEnd, value: low },
      { name: "high", label: S.highEnd, value: high },
    ],
    S.ok,
    (values) => {
      const ends = readEnds(values.low, values.high);
      return ends
        ? attempt("range", { variable: variable.name, low: sendable(ends[0]), high: sendable(ends[1]) })
        : { error: S.notARange(values.low, values.high) };
    },
  );
}

function renameVariable({ rename, attempt }, variable) {
  return rename(variable.name, (name) => attempt("variable", { variable: variable.name, name }));
}

function remove({ fill, attempt }, variable) {
  return fill(
    S.removeVariable(variable.name),
    [],
    S.remove,
    () => attempt("variable", { variable: variable.name }),
    S.removeVariableNote,
  );
}

/** The shape of a new term: a triangle, or a singleton where all are. */
export function newShape(variable, peak) {
  const [low, high] = rangeOf(variable);
  const half = (high - low) / (variable.terms.length + 1);
  const discrete = variable.terms.length && variable.terms.every((term) => term.kind === "singleton");
  const numbers = discrete ? [peak] : [peak - half, peak, peak + half];
  return { kind: discrete ? "singleton" : "triangle", parameters: numbers.map((x) => Number(x.toPrecision(6))) };
}

function addTerm({ fill, attempt }, variable, peak) {
  return fill(
    S.nameOfTerm(variable.name),
    [
      { name: "term", label: S.name, value: "" },
      { name: "peak", label: S.peak, value: shortNumber(peak, 6) },
    ],
    S.add,
    ({ term, peak: at }) => {
      const number = readNumber(at);
      if (!Number.isFinite(number)) return { error: S.noNumber(at) };
      return attempt("term", { variable: variable.name, term: term.trim(), shape: newShape(variable, number) });
    },
  );
}

/**
 * The line above a plot; `peakOf` says where a new term would stand. Without a `hand` it only tells.
 *
 * @param {Page.Hand} hand
 */
export function variableHead(hand, peakOf) {
  let variable = null;
  const name = el("strong");
  const words = el("span");
  const button = (text, label, act) =>
    el("button", { textContent: text, title: label, onclick: () => act(hand, variable, peakOf(variable)) });
  const tools = !hand.attempt
    ? []
    : [
        button(S.addTerm, S.addTermHint, addTerm),
        button(S.range, S.rangeHint, stretch),
        button(S.renameDots, S.renameVariable, renameVariable),
        button("×", S.removeVariableHint, remove),
      ];
  const element = el("div", { class: "head" }, name, words, space(), ...tools);
  return {
    element,
    show(now, role) {
      variable = now;
      name.textContent = now.name;
      words.replaceChildren(el("span", { class: "role", textContent: `${role} ` }), endsWords(now));
      words.title = now.description;
      for (const tool of tools) {
        const label = `${now.name}: ${tool.title}`;
        // Who speaks to the page says what stands on the button.
        tool.setAttribute("aria-label", label.includes(tool.textContent) ? label : `${label}: ${tool.textContent}`);
      }
    },
  };
}
