"""Give declarations their meaning: variables, terms, shapes, settings; and the scope of names."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TypedDict

from fuzzyarm.base.diagnostic import (
    MAX_DIAGNOSTICS,
    MAX_INPUTS,
    MAX_MAGNITUDE,
    MAX_OUTPUTS,
    MAX_TERMS,
    MIN_WIDTH,
    Diagnostic,
    Related,
    Severity,
    Span,
    Word,
)
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.model.rulebase import POSITION, Defuzzifier, Shape, Term
from fuzzyarm.language.model.shapes import first_above, first_sample_above, membership_function
from fuzzyarm.language.phrases import SETTINGS, SettingNode, ShapeNode
from fuzzyarm.language.statements import (
    BlockNode,
    EvenTermsNode,
    InferenceNode,
    TermNode,
    VariableNode,
)
from fuzzyarm.language.tokens import name_text
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SHAPES

# --- The names in scope, and the findings ---

_MOST_HINTS = 200
"""Number of findings with hints; later ones have none."""


class Draft:
    """A variable under construction."""

    def __init__(self, node: VariableNode) -> None:
        self.node = node
        self.name = str(node.name)
        self.is_input = node.role == "input"
        self.terms: dict[str, Term] = {}
        self.spread: set[str] = set()  # names of terms from a `terms` line
        self.outside = "clamp"
        self.aggregation = ""  # empty: that of the defuzzifier
        self.defuzzifier = Defuzzifier()
        self.no_rule: float | str = "error"


class Scope:
    """The variables of a file by name, and the findings so far.

    `broken_variables` is true if a declaration was unreadable, `full` has the roles with too many
    variables, `presumed` the names in rules where no variable of their role is declared, which is
    one finding.
    """

    def __init__(self) -> None:
        self.drafts: dict[str, Draft] = {}
        self.diagnostics: list[Diagnostic] = []
        self.broken_variables = False
        self.full: set[str] = set()
        self.presumed: frozenset[str] = frozenset()

    @property
    def overflows(self) -> bool:
        """Whether the findings exceed the limit of one run, so that further search is useless."""
        return len(self.diagnostics) > MAX_DIAGNOSTICS

    def report(
        self,
        name: str,
        message: str,
        span: Span,
        *,
        hint: str = "",
        replacement: str | None = None,
        severity: Severity = Severity.ERROR,
        related: tuple[Related, ...] = (),
    ) -> None:
        """Add a finding."""
        self.diagnostics.append(
            Diagnostic(name, message, span, severity, hint, replacement, related=related)
        )

    def variable(self, word: Word, role: str = "") -> Draft | None:
        """Return the variable `word`; report it if none of that role exists."""
        draft = self.drafts.get(word)
        if draft is None:
            # A broken `input` line is reported once, not at every use of its name.
            if not self.broken_variables and word not in self.presumed:
                self.unknown("unknown-variable", "variable", word, word.span, self.names(role))
            return None
        if role and draft.node.role != role:
            article = "an input" if draft.is_input else "an output"
            self.report(
                f"not-an-{role}",
                f"'{word}' is {article}, not an {role}",
                word.span,
                related=(Related(f"'{word}' is declared here", draft.node.name.span),),
            )
            return None
        return draft

    def term(self, draft: Draft | None, word: Word) -> Term | None:
        """Return the term `word` of `draft`; report it if there is none."""
        if draft is None:
            return None
        term = draft.terms.get(word)
        if term is None:
            what = f"term of '{draft.name}'"
            self.unknown("unknown-term", what, word, word.span, draft.terms)
        return term

    def names(self, role: str = "") -> list[str]:
        """Return the names of the variables of `role`, or of all."""
        return [name for name, draft in self.drafts.items() if role in ("", draft.node.role)]

    def unknown(
        self, finding: str, what: str, name: str, span: Span, choices: Iterable[str], new: str = ""
    ) -> None:
        """Report an unknown name; `new` has the way to declare it."""
        options = list(choices)
        hint, replacement = "", None
        if len(self.diagnostics) < _MOST_HINTS:
            hint, replacement = near_hint(name, options)
        if not hint:
            more = ", …" if len(options) > 10 else ""
            listing = f"there are {', '.join(options[:10])}{more}" if options else ""
            hint = "; ".join(filter(None, (listing, new)))
        self.report(
            finding, f"no {what} is called '{name}'", span, hint=hint,
            replacement=None if replacement is None else name_text(replacement),
        )  # fmt: skip


# --- Shapes ---


def _elaborate_shape(node: ShapeNode, draft: Draft | None, scope: Scope) -> Shape | None:
    """Return the shape of `node`, or None after a report."""
    height = 1.0 if node.height is None else node.height
    if not 0.0 < height <= 1.0:
        assert node.height is not None
        scope.report("bad-height", "a height must be above 0 and at most 1", node.height.span)
        return None
    kind = str(node.kind)
    if not SHAPES[kind].fuzzy and draft is not None and draft.is_input:
        scope.report(
            "not-a-fuzzy-set",
            f"'{kind}' is a value, not a set: it cannot be a term of the input '{draft.name}'",
            node.kind.span,
        )
        return None
    if kind == "linear":
        return _linear(node, scope)
    if kind == "formula":
        return _formula(node, scope)
    parameters = tuple(map(float, node.figures))
    misfit = next(SHAPES[kind].misfits(parameters), None)
    if misfit is not None:
        index, _, message = misfit
        right = _turned_round(kind, parameters)
        if right:
            span = node.figures[0].span.to(node.figures[-1].span)
            hint = f"write  {kind} {right}"
            scope.report("bad-shape", message, span, hint=hint, replacement=right)
        else:
            scope.report("bad-shape", message, node.figures[index].span)
        return None
    return Shape(kind, parameters, float(height))


def _turned_round(kind: str, parameters: tuple[float, ...]) -> str:
    """Return the numbers of a shape that were written from right to left the right way round."""
    turned = parameters[::-1]
    if kind == "points" or turned != tuple(sorted(turned)):
        return ""
    if any(SHAPES[kind].misfits(turned)):
        return ""
    return " ".join(map(number_text, turned))


def _linear(node: ShapeNode, scope: Scope) -> Shape | None:
    inputs = scope.names("input")
    coefficients = dict.fromkeys(inputs, 0.0)
    constant = 0.0
    for part in node.parts:
        if part.variable is None:
            constant += part.factor
        elif scope.variable(part.variable, "input") is not None:
            coefficients[part.variable] += part.factor
    return Shape("linear", (*coefficients.values(), constant))


def _formula(node: ShapeNode, scope: Scope) -> Shape | None:
    from fuzzyarm.symbolic.formulas import CONSTANTS, FormulaError, read_formula

    try:
        formula = read_formula(node.formula)
    except FormulaError as error:
        scope.report("bad-formula", error.message, node.formula_span)
        return None
    for name in sorted(formula.names):
        if name not in scope.drafts and name not in CONSTANTS and name != POSITION:
            hint, _ = near_hint(name, scope.drafts)
            message = f"unknown variable '{name}' in the formula"
            scope.report("unknown-variable", message, node.formula_span, hint=hint)
    return Shape("formula", formula=str(node.formula))


def _elaborate_lower(node: ShapeNode, upper: Shape, draft: Draft, scope: Scope) -> Shape | None:
    """Return the part after ``over``, the lower of two; None after a report."""
    lower = _elaborate_shape(node, draft, scope)
    if lower is None:
        return None
    message = _no_interval(upper, lower, draft)
    if message:
        scope.report("bad-interval", message, node.kind.span)
        return None
    message = _lower_above(upper, lower, *range_of(draft.node))
    if message:
        span = node.kind.span.to(node.figures[-1].span) if node.figures else node.kind.span
        hint = "write the upper one before `over`"
        scope.report("lower-above-upper", message, span, hint=hint)
        return None
    return lower


def _no_interval(upper: Shape, lower: Shape, draft: Draft) -> str:
    """Return why the interval between two shapes is empty; "" for a valid one."""
    kinds = {upper.kind, lower.kind}
    if len(kinds) > 1 and kinds & {"singleton", "linear", "formula"}:
        return f"{upper.kind} over {lower.kind}: both must be sets, or values of one kind"
    if upper.kind == "singleton" and draft.is_input:
        return f"a singleton over a singleton is a value between two, and '{draft.name}' an input"
    return ""


def _lower_above(upper: Shape, lower: Shape, low: float, high: float) -> str:
    """Return where the lower of two shapes exceeds the upper one; empty if nowhere."""
    if upper.kind == "singleton":
        one, other = lower.parameters[0], upper.parameters[0]
        return f"the lower value {one:g} is above the upper one {other:g}" if one > other else ""
    if upper.kind == "linear":
        return ""  # values of the inputs: whichever is less is the lower one
    below, above = _degrees_of(lower), _degrees_of(upper)
    if below is None or above is None:
        return ""
    if upper.kind == "formula":
        x = first_sample_above(below, above, low, high)
    else:
        x = first_above(lower, upper, low, high)
    if x is None:
        return ""
    return (
        f"the lower membership function is above the upper one at {x:.6g}:"
        f" {below(x):.6g} > {above(x):.6g}"
    )


def _degrees_of(shape: Shape) -> Callable[[float], float] | None:
    """Return a shape as a function; None for a formula of more than the position."""
    if shape.kind != "formula":
        return membership_function(shape)
    from fuzzyarm.symbolic.formulas import FormulaError, read_formula

    try:
        formula = read_formula(shape.formula)
    except FormulaError:  # reported already
        return None
    return formula.function((POSITION,)) if formula.names == (POSITION,) else None


# --- Variables and terms ---

_LIMITS = {"input": MAX_INPUTS, "output": MAX_OUTPUTS}


def declare_variable(node: VariableNode, scope: Scope) -> None:
    """Add the variable of `node` to `scope`."""
    draft = scope.drafts.get(node.name)
    if draft is not None:
        scope.report(
            "duplicate-variable",
            f"'{node.name}' is declared twice",
            node.name.span,
            related=(Related("first here", draft.node.name.span),),
        )
        return
    if len(scope.names(node.role)) == _LIMITS[node.role]:
        if node.role not in scope.full:
            scope.report(
                "too-many-variables",
                f"more than {_LIMITS[node.role]} {node.role}s",
                node.name.span,
            )
        scope.full.add(node.role)
        scope.broken_variables = True
        return
    if node.low is not None and node.high is not None and not node.low < node.high:
        turned = (
            f"{number_text(node.high)} .. {number_text(node.low)}" if node.low > node.high else None
        )
        scope.report(
            "bad-range",
            f"the range of '{node.name}' must go from a lower to a higher number",
            node.low.span.to(node.high.span),
            hint=f"write  {node.role} {name_text(node.name)} {turned}" if turned else "",
            replacement=turned,
        )
    elif node.low is not None and node.high is not None:
        fault = _range_fault(node.low, node.high)
        if fault is not None:
            span = node.low.span.to(node.high.span)
            scope.report("bad-range", f"the range of '{node.name}' {fault}", span)
    scope.drafts[node.name] = Draft(node)


def _range_fault(low: float, high: float) -> str | None:
    """Return why the range from `low` to `high` is invalid, or None."""
    if any(MAX_MAGNITUDE < abs(end) < math.inf for end in (low, high)):
        return f"goes beyond {MAX_MAGNITUDE:g}"
    if high - low < MIN_WIDTH:
        return f"is narrower than {MIN_WIDTH:g}"
    return None


def range_of(node: VariableNode) -> tuple[float, float]:
    """Return the range of a variable, swapped ends in order; 0 to 1 where the file's is not one."""
    if node.low is None or node.high is None:
        return 0.0, 1.0
    low, high = sorted((float(node.low), float(node.high)))
    if not low < high or _range_fault(low, high):
        return 0.0, 1.0
    return low, high


def add_term(node: TermNode, scope: Scope) -> None:
    """Add the explicit term of `node` to its variable."""
    draft = scope.variable(node.variable)
    shape = None if node.shape is None else _elaborate_shape(node.shape, draft, scope)
    lower = None
    below = node.shape.lower if node.shape is not None else None
    if below is not None and shape is not None and draft is not None:
        lower = _elaborate_lower(below, shape, draft, scope)
    if draft is not None:
        # A term with a bad shape is declared all the same, so that its uses are not mistakes too.
        shape = shape or Shape("singleton", (0.0,))
        _add(draft, Term(str(node.name), shape, node.name.span, lower), scope)


def add_even_terms(node: EvenTermsNode, scope: Scope) -> None:
    """Spread the terms of `node` evenly over the range of each of its variables."""
    for word in node.variables:
        draft = scope.variable(word)
        if draft is None:
            continue
        low, high = range_of(draft.node)
        if not (math.isfinite(low) and math.isfinite(high)):
            scope.report(
                "bad-range",
                f"'{draft.name}' has no finite range to spread over",
                word.span,
                hint="give it a finite range, or its terms lines of their own:  term …",
            )
            # The terms are known anyway, so that their uses are not reported, too.
            for name in node.names:
                _add(draft, Term(str(name), Shape("singleton", (0.0,)), name.span), scope)
            continue
        if len(node.names) < 2 and node.family != "singletons":
            scope.report(
                "too-few-terms", "evenly spaced terms need at least two names", node.names[0].span
            )
            continue
        if node.family == "singletons" and draft.is_input:
            scope.report(
                "singleton-input",
                f"singletons would leave the input '{draft.name}' uncovered between them",
                node.family.span,
            )
        shapes = even_shapes(node.family, len(node.names), low, high)
        for name, shape in zip(node.names, shapes, strict=True):
            _add(draft, Term(str(name), shape, name.span), scope, spread=True)


def even_shapes(family: str, count: int, low: float, high: float) -> list[Shape]:
    """Return `count` shapes of `family` with peaks spread evenly from `low` to `high`.

    Triangles have their feet under the neighbouring peaks, gaussians cross their neighbours at one
    half, singletons are at the peaks. A single shape is in the middle.
    """
    if count == 1:
        return [Shape("singleton", (0.5 * (low + high),))]
    step = (high - low) / (count - 1)
    peaks = [low + (high - low) * i / (count - 1) for i in range(count)]
    if family == "singletons":
        return [Shape("singleton", (peak,)) for peak in peaks]
    if family == "gaussians":
        deviation = step / (2.0 * math.sqrt(2.0 * math.log(2.0)))
        return [Shape("gaussian", (peak, deviation)) for peak in peaks]
    # Feet are the neighbours' peaks to the last bit, so that memberships add up to one.
    feet = [low - step, *peaks, high + step]
    return [Shape("triangle", (feet[i], feet[i + 1], feet[i + 2])) for i in range(count)]


def _add(draft: Draft, term: Term, scope: Scope, *, spread: bool = False) -> None:
    earlier = draft.terms.get(term.name)
    if earlier is not None and (term.name in draft.spread) != spread:
        # A `term` line overrides the shape from `terms`, in either order.
        if not spread:
            draft.terms[term.name] = term
            draft.spread.discard(term.name)
        return
    if earlier is not None:
        scope.report(
            "duplicate-term",
            f"'{draft.name}' has two terms called '{term.name}'",
            term.span,
            related=(Related("first here", earlier.span),),
        )
        return
    if len(draft.terms) > MAX_TERMS:
        return
    if len(draft.terms) == MAX_TERMS:
        scope.report("too-many-terms", f"'{draft.name}' has more than {MAX_TERMS} terms", term.span)
    draft.terms[term.name] = term
    if spread:
        draft.spread.add(term.name)


# --- Settings of `inference` and `block` ---

_MAX_SAMPLES = 1_000_000


class Norms(TypedDict, total=False):
    """The norms of a block of rules; see RuleBlock."""

    conjunction: str
    disjunction: str
    implication: str
    threshold: float


def apply_inference(node: InferenceNode, scope: Scope, norms: Norms) -> None:
    """Apply an ``inference`` line: to all variables and blocks, or to the variable it names."""
    drafts = list(scope.drafts.values())
    if node.target is not None:
        draft = scope.variable(node.target)
        drafts = [] if draft is None else [draft]
    _report_repeated(node.settings, scope)
    for setting in node.settings:
        if SETTINGS[setting.key].of == "rules":
            if node.target is not None:
                scope.report(
                    "misplaced-setting",
                    f"'{setting.key}' belongs to rules, not to the variable '{node.target}'",
                    setting.key.span,
                    hint="set it on a line of its own without a name, or on a block",
                )
            else:
                _set_norm(setting, scope, norms)
            continue
        for draft in drafts:
            _apply(setting, draft, scope, named=node.target is not None)


def block_norms(node: BlockNode, scope: Scope, norms: Norms) -> Norms:
    """Return the norms of a block: those of the file, overridden by its own."""
    block_settings = norms.copy()
    _report_repeated(node.settings, scope)
    for setting in node.settings:
        if SETTINGS[setting.key].of == "rules":
            _set_norm(setting, scope, block_settings)
        else:
            scope.report(
                "misplaced-setting",
                f"'{setting.key}' belongs to an output, not to a block",
                setting.key.span,
                hint="write it on an inference line",
            )
    return block_settings


def _set_norm(setting: SettingNode, scope: Scope, norms: Norms) -> None:
    if setting.figure is not None:
        if not 0.0 <= setting.figure < 1.0:
            scope.report(
                "bad-threshold", "a threshold must be at least 0 and below 1", setting.figure.span
            )
        norms["threshold"] = float(setting.figure)
    elif setting.value is not None:
        key = setting.key
        if key == "and":
            norms["conjunction"] = str(setting.value)
        elif key == "or":
            norms["disjunction"] = str(setting.value)
        else:
            norms["implication"] = str(setting.value)


def _report_repeated(settings: tuple[SettingNode, ...], scope: Scope) -> None:
    keys: set[str] = set()
    for setting in settings:
        if setting.key in keys:
            scope.report("duplicate-setting", f"'{setting.key}' is set twice", setting.key.span)
        keys.add(setting.key)


def _apply(setting: SettingNode, draft: Draft, scope: Scope, *, named: bool) -> None:
    key = setting.key
    if key == "outside":
        assert setting.value is not None
        draft.outside = str(setting.value)
    elif draft.is_input:
        if named:
            scope.report(
                "misplaced-setting",
                f"'{key}' belongs to an output; '{draft.name}' is an input",
                setting.key.span,
            )
    elif key == "aggregation":
        assert setting.value is not None
        draft.aggregation = str(setting.value)
    elif key == "no-rule":
        if setting.value is not None:
            draft.no_rule = str(setting.value)
        elif setting.figure is not None:
            draft.no_rule = float(setting.figure)
    else:
        draft.defuzzifier = _defuzzifier(setting, scope)


def _defuzzifier(setting: SettingNode, scope: Scope) -> Defuzzifier:
    assert setting.value is not None
    method = str(setting.value)
    if setting.resolution is None:
        return Defuzzifier(method)
    samples = float(setting.resolution)
    record = DEFUZZIFIERS[method]
    if record.weighs:
        scope.report(
            "misplaced-setting", f"{method} takes no number of samples", setting.resolution.span
        )
    elif samples != int(samples) or not 2 <= samples <= _MAX_SAMPLES:
        scope.report(
            "bad-resolution",
            f"the number of samples must be a whole number from 2 to {_MAX_SAMPLES:,}",
            setting.resolution.span,
        )
        return Defuzzifier(method)
    sampling = "endpoints" if setting.sampling is None else str(setting.sampling)
    if setting.sampling is not None and sampling == "joined" and not record.joins:
        message = f"{method} does not know joined samples"
        scope.report("misplaced-setting", message, setting.sampling.span)
    return Defuzzifier(method, int(samples), sampling)
