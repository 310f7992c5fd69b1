// The kernel of fuzzyarm around a rule base: blocks of numbers, points, grids, what fires.
//
// The functions of the kernel stand above, translated from their Python; the constants that
// name places in a block are theirs. See fuzzyarm/inference/block.py for the picture of a block.

/** Functions by their number while an engine runs: a program calls them so. */
let table = [];

function call(address, a, b, c, d) {
  table[address](a, b, c, d);
}

// Of equal arguments the first, also beside NaN, as in Python.
function min(a, b) {
  return b < a ? b : a;
}

function max(a, b) {
  return b > a ? b : a;
}

function power(a, b) {
  if (a === 1 || (a === -1 && (b === Infinity || b === -Infinity))) return 1; // NaN here otherwise
  return a ** b;
}

/** The nearest whole number, of two the even one. */
function rint(x) {
  const nearest = Math.round(x);
  return Math.abs(x % 1) === 0.5 && nearest % 2 !== 0 ? nearest - 1 : nearest;
}

function remainder(a, b) {
  return a % b;
}

/**
 * A function of x and some numbers from an expression as nested lists: [operation, …], a number,
 * or a name: x, n0, n1, …, or that of a number that JSON does not have.
 */
function formula(tree) {
  if (typeof tree === "number") return () => tree;
  if (tree === "x") return (x) => x;
  if (typeof tree === "string") {
    const number = Number(tree);
    const index = Number(tree.slice(1));
    return tree[0] === "n" ? (x, numbers) => numbers[index] : () => number;
  }
  const [name, ...rest] = tree;
  const operation = OPERATIONS[name];
  const [a, b, c] = rest.map(formula);
  if (name === "where") return (x, n) => (a(x, n) ? b(x, n) : c(x, n));
  return b ? (x, n) => operation(a(x, n), b(x, n)) : (x, n) => operation(a(x, n));
}

/** What stands behind a number of a layout, from its description. */
function linked(wanted) {
  if (wanted.program) return PROGRAMS_BY_NAME[wanted.program];
  if (wanted.norm) return (wanted.sort === "T" ? TNORMS : SNORMS)[wanted.norm];
  const hedges = (wanted.hedges ?? []).map(([name, exponent]) => [HEDGES[name], exponent]);
  const own = wanted.formula && formula(wanted.formula);
  const degrees = wanted.shape && SHAPES[wanted.shape];
  return (x, numbers, into) => {
    if (own) for (let i = 0; i < into.length; i++) into[i] = own(x[i], numbers);
    else if (degrees) degrees(x, numbers, into);
    else for (let i = 0; i < into.length; i++) into[i] = x[i];
    if (wanted.height) {
      const height = numbers[numbers.length - 1];
      for (let i = 0; i < into.length; i++) into[i] = height * into[i];
    }
    for (const [hedge, exponent] of hedges) {
      for (let i = 0; i < into.length; i++) into[i] = hedge(into[i], exponent);
    }
  };
}

function bytesOf(text) {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
}

/** A rule base as numbers, ready to be evaluated. Where there is no ordinary value it gives NaN. */
class Engine {
  constructor(data) {
    this.data = data;
    this.whole = new Int32Array(bytesOf(data.whole));
    this.floats = new Float64Array(bytesOf(data.floats));
    this.functions = [null, null, null, null, ...data.functions.map(linked)]; // 0 … 3: own norms
    this.blocks = new Map();
  }

  /** The numbers with room for some points; in the order of memory. */
  block(points) {
    if (this.blocks.has(points)) return this.blocks.get(points);
    const { whole, floats, data } = this;
    const [inputs, outputs] = [whole[INPUTS], whole[OUTPUTS]];
    const lengths = [
      [FLOATS, whole.length], [SCRATCH, floats.length],
      [COLUMNS, data.rows * points + 2 * data.samples], [RESULTS, inputs * points],
      [ORDERED, outputs * points], [ORDER, inputs * points], [ENDS, 2 * points],
      [SIZE, data.programs + 2],
    ];
    const size = lengths.reduce((sum, [, length]) => sum + length, 0);
    const block = new Float64Array(size);
    const k = (block.whole = new Int32Array(size));
    k.set(whole);
    k[POINTS] = k[WIDTH] = points;
    let end = 0;
    for (const [name, length] of lengths) k[name] = end += length;
    block.set(floats, k[FLOATS]);
    block.fill(1, k[SCRATCH] + ONES * points, k[SCRATCH] + (ONES + 1) * points);
    if (this.blocks.size > 3) this.blocks.clear();
    this.blocks.set(points, block);
    return block;
  }

  /** Change floats in place; for loose layouts. */
  patch(at, numbers) {
    this.floats.set(numbers, at);
    for (const block of this.blocks.values()) block.set(numbers, block.whole[FLOATS] + at);
  }

  /** Change a whole number in place. */
  patchWhole(at, number) {
    this.whole[at] = number;
    for (const block of this.blocks.values()) block.whole[at] = number;
  }

  /** The outputs at a point, from the inputs in their order. */
  at(values) {
    const block = this.block(1);
    const k = block.whole;
    block.set(values, k[COLUMNS]);
    table = this.functions;
    evaluate(block);
    return Array.from(block.subarray(k[RESULTS], k[RESULTS] + k[OUTPUTS]));
  }

  /** The left and the right end of each output at a point; both the value of one without ends. */
  ends(values) {
    const value = this.at(values);
    const places = this.data.intervals.map((output) =>
      this.whole[this.whole[OUTPUTS_AT] + output * OUTPUT_HEAD + FLOATS_AT] + OUTPUT_RANGE - 1);
    const asked = places.map((place) => this.floats[place]);
    const found = [-1, 1].map((end) => {
      for (const place of places) this.patch(place, [end]);
      return this.at(values);
    });
    places.forEach((place, i) => this.patch(place, [asked[i]]));
    return value.map((each, o) =>
      (this.data.intervals.includes(o) ? [found[0][o], found[1][o]] : [each, each]));
  }

  /** The outputs at many points: a column for each input; a row for each output comes back. */
  many(columns) {
    const points = columns[0].length;
    const block = this.block(points);
    const k = block.whole;
    columns.forEach((column, i) => block.set(column, k[COLUMNS] + i * points));
    table = this.functions;
    sweep(block);
    return Array.from({ length: k[OUTPUTS] }, (_, o) =>
      block.slice(k[RESULTS] + o * points, k[RESULTS] + (o + 1) * points));
  }

  /** Degrees of a set at some positions, by its number and the numbers that it takes. */
  degrees(address, numbers, x, into = new Float64Array(x.length)) {
    table = this.functions;
    call(address, x, numbers, into);
    return into;
  }

  /**
   * How far every rule fires at a point: read from the program of the point, in which the other
   * rules cannot fire. Null where the point is in no program.
   */
  fired(values) {
    const block = this.block(1);
    const k = block.whole;
    k[PROGRAM] = 0;
    const outputs = this.many(values.map((value) => [value])).map(([value]) => value); // row by row: it notes its program
    if (!k[PROGRAM]) return null;
    const f = block.subarray(k[FLOATS], k[SCRATCH]);
    const scratch = block.subarray(k[SCRATCH], k[COLUMNS]);
    const strengths = new Float64Array(this.data.rules);
    const row = new Float64Array(1);
    let at = k[PROGRAM] + 2 * k[INPUTS];
    let expressions = k[at++];
    for (; expressions > 0; expressions--) at += TRUTH_HEAD + k[at + 3];
    for (let o = 0; o < k[OUTPUTS]; o++) {
      let groups = k[at++];
      for (; groups > 0; groups--) {
        let rules = k[at];
        at += GROUP_HEAD;
        for (; rules > 0; rules--) {
          fire(k, f, scratch, at, row);
          strengths[(k[at + 1] - this.data.weights) / 2] = row[0];
          at += RULE_HEAD + k[OPERANDS];
        }
      }
      const head = k[OUTPUTS_AT] + o * OUTPUT_HEAD;
      if (this.functions[k[head + DEFUZZIFIER]] === closed_centroid) {
        let unions = k[at++];
        for (; unions > 0; unions--) at += 1 + k[at];
        at += 1 + 3 * k[at];
      }
    }
    return { outputs, strengths };
  }

  /** The positions at which an output is sampled. */
  positions(output) {
    const head = this.whole[OUTPUTS_AT] + output * OUTPUT_HEAD;
    const begin = this.whole[head + FLOATS_AT] + OUTPUT_RANGE;
    return this.floats.slice(begin, begin + this.whole[head + DETAIL]);
  }

  /** Two degrees under a norm, by its number. */
  joined(norm, a, b) {
    table = this.functions;
    const into = new Float64Array(1);
    join(norm, Float64Array.of(a), Float64Array.of(b), into);
    return into[0];
  }

  /** Cut a set at a height and fold it into an aggregate, both as rows of samples. */
  cut(implication, fold, height, degrees, aggregate) {
    table = this.functions;
    cut_in(implication, fold, height, degrees, aggregate, new Float64Array(degrees.length));
  }
}
