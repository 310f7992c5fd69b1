"""Chained rule bases as one: MATLAB's trees of fuzzy systems (`fistree`).

A connection leads from an output of one rule base to an input of another, or joins two inputs of
the same value. In the joint rule base a connected output also has the terms of the inputs that it
feeds, so that later blocks can read it; each rule base keeps its norms in its own blocks, in an
order of evaluation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple, TypeVar

from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.formats.findings import Findings, Imported, TextPiece, unique_name
from fuzzyarm.language.model.rulebase import (
    And,
    AnyRuleBase,
    Consequent,
    Expression,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    model_of,
)
from fuzzyarm.symbolic.formulas import FormulaError, read_formula, write_formula

_Part = TypeVar("_Part", Is, Consequent)


class Connection(NamedTuple):
    """A connection to an input of a rule base; both ends are (rule base, variable)."""

    source: tuple[str, str]
    target: tuple[str, str]

    def __str__(self) -> str:
        return f"{_place(self.source)} -> {_place(self.target)}"


def read_connection(text: str) -> Connection | None:
    """Return the connection ``a/out -> b/in``; None for any other text."""
    source, arrow, target = text.partition("->")
    ends = [tuple(part.strip() for part in end.partition("/")[::2]) for end in (source, target)]
    if not arrow or not all(name for end in ends for name in end):
        return None
    (one, out), (other, into) = ends
    return Connection((one, out), (other, into))


def tree(
    rulebases: Mapping[str, AnyRuleBase],
    connections: Iterable[Connection | str],
    name: str = "tree",
    *,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    r"""Join rule bases, connected like a ``fistree`` of MATLAB.

    Parameters
    ----------
    rulebases : mapping of str to RuleBase
        Rule bases under the names in the connections.
    connections : iterable of Connection or str
        As ``"a/out -> b/in"``: an output or input of one rule base, an input of another.
    name : str
        Name of the joint rule base.
    lossy, strict : bool
        As for :func:`fuzzyarm.exchange.formats.parse`.

    Returns
    -------
    Imported
        The rule base, if there is no error, and every finding.

    Examples
    --------
    >>> import fuzzyarm
    >>> from fuzzyarm.exchange.formats.trees import tree
    >>> a = fuzzyarm.parse("input x 0 .. 1\noutput y 0 .. 1\nterms x, y: triangles L H\n"
    ...                    "rule if x is L then y is H\nrule if x is H then y is L\n").rulebase
    >>> both = tree({"a": a, "b": a}, ["a/y -> b/x"]).rulebase
    >>> [variable.name for variable in (*both.inputs, *both.outputs)]
    ['x', 'a_y', 'b_y']
    """
    findings = Findings(lossy=lossy, strict=strict)
    parts = {key: model_of(rulebase) for key, rulebase in rulebases.items()}
    parsed = list(_read(connections, findings))
    valid = [connection for connection in parsed if _is_known(connection, parts, findings)]
    order = _order(parts, valid, findings)
    if findings.failed:
        return findings.imported(None, "fuzzyarm")
    _note_apart(parts, valid, findings)
    rulebase = _Joint(parts, valid, findings).rulebase(name, order)
    return findings.imported(rulebase, "fuzzyarm")


def _place(end: tuple[str, str]) -> str:
    return "/".join(end)


# --- Connections: reading and checks ---


def _read(connections: Iterable[Connection | str], findings: Findings) -> Iterator[Connection]:
    for text in connections:
        connection = read_connection(text) if isinstance(text, str) else text
        if connection is None:
            message = f"'{str(text)[:60]}' is not a connection"
            findings.error("syntax", message, hint="write it as  a/out -> b/in")
        else:
            yield connection


def _is_known(connection: Connection, parts: Mapping[str, RuleBase], findings: Findings) -> bool:
    """Whether both ends exist and the second one is an input; report it if not."""
    for end in connection:
        part = parts.get(end[0])
        if part is None:
            findings.unknown("unknown-rulebase", "the rule base", TextPiece(end[0]), parts)
            return False
        inputs = [variable.name for variable in part.inputs]
        names = inputs + [output.name for output in part.outputs]
        if end is connection.target and end[1] in names and end[1] not in inputs:
            message = f"'{_place(end)}' is an output; a connection leads to an input"
            findings.error("not-an-input", message)
            return False
        choices = inputs if end is connection.target else names
        if end[1] not in choices:
            role = "input" if end is connection.target else "variable"
            message = f"the rule base '{end[0]}' has no {role}"
            findings.unknown("undefined-variable", message, TextPiece(end[1]), choices, ending="")
            return False
    return True


def _order(
    parts: Mapping[str, RuleBase], connections: Sequence[Connection], findings: Findings
) -> list[str]:
    """Return the rule bases in order of evaluation; report cycles and clashes."""
    waits: dict[str, set[str]] = {key: set() for key in parts}
    sources: dict[tuple[str, str], tuple[str, str]] = {}
    for source, target in connections:
        if target in sources:
            message = f"two connections lead to '{_place(target)}'"
            findings.error("duplicate-connection", message)
        sources[target] = source
        # Joined inputs do not depend on each other: both read the same value.
        if any(source[1] == output.name for output in parts[source[0]].outputs):
            waits[target[0]].add(source[0])
    try:
        order = list(TopologicalSorter(waits).static_order())
    except CycleError as error:
        circle = " -> ".join(reversed(error.args[1]))
        message = f"the connections go in a circle: {circle}"
        findings.error("circle", message, hint="cut it, or let a controller delay a signal")
        return []
    for target in sources:
        end, visited = target, {target}
        while end in sources:
            end = sources[end]
            if end in visited:
                message = f"the inputs '{_place(target)}' and '{_place(end)}' wait for each other"
                findings.error("circle", message)
                return []
            visited.add(end)
    # Independent rule bases keep the given order.
    places = {key: place for place, key in enumerate(parts)}
    depth: dict[str, int] = {}
    for key in order:
        depth[key] = max((depth[other] + 1 for other in waits[key]), default=0)
    return sorted(order, key=lambda key: (depth[key], places[key]))


def _note_apart(
    parts: Mapping[str, RuleBase], connections: Sequence[Connection], findings: Findings
) -> None:
    connected = {end[0] for connection in connections for end in connection}
    for key in parts:
        if key not in connected:
            findings.warn("not-connected", f"no connection leads to '{key}' or from it")


# --- The joint rule base ---


@dataclass(slots=True)
class _Shared:
    """A variable of the joint rule base: an input or output of a part, and the inputs it feeds."""

    variable: Input | Output
    key: str  # its part
    name: str = ""
    terms: list[Term] = field(default_factory=list)
    renamed: dict[tuple[str, str, str], str] = field(default_factory=dict)
    """(rule base, variable, term) → its name in the joint rule base."""


class _Joint:
    """Joins rule bases along checked connections."""

    def __init__(
        self,
        parts: Mapping[str, RuleBase],
        connections: Sequence[Connection],
        findings: Findings,
    ) -> None:
        self.parts = parts
        self.findings = findings
        self.sources = {connection.target: connection.source for connection in connections}
        self.shared: dict[tuple[str, str], _Shared] = {}

    def rulebase(self, name: str, order: Sequence[str]) -> RuleBase:
        """Return the joint rule base of parts in order of evaluation."""
        for key in order:
            for variable in _variables(self.parts[key]):
                if (key, variable.name) not in self.sources:
                    self.shared[key, variable.name] = _Shared(variable, key)
        self._settle_names()
        for key in order:
            for variable in _variables(self.parts[key]):
                self._take_terms(key, variable)
        self.inputs = [s for s in self.shared.values() if isinstance(s.variable, Input)]
        blocks = [block for key in order for block in self._blocks(key)]
        for key in order:
            self._note_left_out(self.parts[key])
        return RuleBase(
            name,
            tuple(self._input(shared) for shared in self.inputs),
            tuple(self._output(s) for s in self.shared.values() if isinstance(s.variable, Output)),
            tuple(blocks),
        )

    def root(self, key: str, variable: str) -> _Shared:
        """Return the joint variable of a part's variable."""
        end = (key, variable)
        while end in self.sources:
            end = self.sources[end]
        return self.shared[end]

    def _settle_names(self) -> None:
        """Keep unique names; prefix the others with their rule base."""
        names = [shared.variable.name for shared in self.shared.values()]
        used_names: set[str] = set()
        for shared in self.shared.values():
            original = shared.variable.name
            name = original if names.count(original) == 1 else f"{shared.key}_{original}"
            shared.name = unique_name(name, used_names)
            used_names.add(shared.name)
            if shared.name != original:
                message = f"the variable '{original}' of '{shared.key}' is called '{shared.name}'"
                self.findings.info("renamed", message)

    def _take_terms(self, key: str, variable: Input | Output) -> None:
        """Add the terms of a variable to its joint variable."""
        shared = self.root(key, variable.name)
        by_name = {term.name: term for term in shared.terms}
        for term in variable.terms:
            same = by_name.get(term.name)
            if same is None or same != term:
                name = term.name if same is None else f"{key}_{term.name}"
                name = unique_name(name, set(by_name))
                shared.terms.append(replace(term, name=name))
                by_name[name] = shared.terms[-1]
            else:
                name = term.name
            shared.renamed[key, variable.name, term.name] = name
        if variable is not shared.variable:
            self._note_range(key, variable, shared)

    def _note_range(self, key: str, variable: Input | Output, shared: _Shared) -> None:
        """Report values beyond the range of the input that they feed."""
        source = shared.variable
        low, high = variable.low, variable.high
        if isinstance(source, Input):
            if (low, high, variable.outside) == (source.low, source.high, source.outside):
                return
            message = (
                f"'{key}/{variable.name}' has the range {_range(variable)}, "
                f"'{shared.key}/{source.name}' {_range(source)}; the wider one is taken"
            )
            if "clamp" in (variable.outside, source.outside):
                self.findings.loss(
                    "joined-ranges", f"{message}, and neither is cut off", slight=True
                )
            else:
                self.findings.info("joined-ranges", message)
        elif source.low < low or source.high > high:
            message = (
                f"'{shared.key}/{source.name}' goes over {_range(source)}, beyond the range of "
                f"'{key}/{variable.name}', {_range(variable)}"
            )
            if variable.outside == "clamp":
                message = f"{message}, which cuts it off; a chained output is read as it is"
                self.findings.loss("beyond-input", message)
            else:
                hint = "its terms are read there as they go on"
                self.findings.warn("beyond-input", message, hint=hint)

    def _input(self, shared: _Shared) -> Input:
        variables = [
            variable
            for key, part in self.parts.items()
            for variable in part.inputs
            if self.root(key, variable.name) is shared
        ]
        assert isinstance(shared.variable, Input)
        outside = {variable.outside for variable in variables}
        return replace(
            shared.variable,
            name=shared.name,
            low=min(variable.low for variable in variables),
            high=max(variable.high for variable in variables),
            terms=tuple(shared.terms),
            outside=outside.pop() if len(outside) == 1 else "extend",
        )

    def _output(self, shared: _Shared) -> Output:
        assert isinstance(shared.variable, Output)
        # Only its own terms may be functions of inputs; the added ones are sets.
        term_names = {name for (key, _, _), name in shared.renamed.items() if key == shared.key}
        terms = [
            replace(term, shape=self._shape(shared.key, term.shape))
            if term.name in term_names
            else term
            for term in shared.terms
        ]
        return replace(shared.variable, name=shared.name, terms=tuple(terms))

    # --- Values that depend on inputs ---

    def _shape(self, key: str, shape: Shape) -> Shape:
        """Return a consequent as a function of the joint inputs."""
        part = self.parts[key]
        roots = {variable.name: self.root(key, variable.name) for variable in part.inputs}
        if shape.kind == "linear":
            *factors, constant = shape.parameters
            # A zero factor reads no input, so it alone does not turn the sum into a formula.
            terms = [(f, roots[v.name]) for f, v in zip(factors, part.inputs, strict=True) if f]
            if all(isinstance(root.variable, Input) for _, root in terms):
                return replace(shape, parameters=(*self._factors(terms), constant))
            names = [(factor, self._formula_name(root)) for factor, root in terms]
            sums = [f"{number_text(factor)} * {name}" for factor, name in names]
            return Shape("formula", (), 1.0, " + ".join([*sums, number_text(constant)]))
        if shape.kind != "formula":
            return shape
        rename = {name: self._formula_name(root) for name, root in roots.items()}
        rename |= {o.name: self._formula_name(self.root(key, o.name)) for o in part.outputs}
        try:
            text = write_formula(read_formula(shape.formula).root, rename=rename)
        except FormulaError as fault:
            self.findings.error("bad-formula", f"in '{shape.formula[:60]}': {fault}")
            return shape
        return replace(shape, formula=text)

    def _factors(self, used: Sequence[tuple[float, _Shared]]) -> list[float]:
        """Return the factors of the joint inputs; those of joined inputs add up."""
        return [
            sum((factor for factor, root in used if root is shared), 0.0) for shared in self.inputs
        ]

    def _formula_name(self, shared: _Shared) -> str:
        if not shared.name.isidentifier():
            message = f"a formula cannot have the name '{shared.name}'"
            self.findings.error("bad-formula", message, hint="rename the variable in its file")
        return shared.name

    # --- Rules ---

    def _blocks(self, key: str) -> Iterator[RuleBlock]:
        for index, block in enumerate(self.parts[key].blocks):
            name = key if index == 0 else f"{key} {block.name or index + 1}"
            yield replace(block, name=name, rules=tuple(self._rule(key, r) for r in block.rules))

    def _rule(self, key: str, rule: Rule) -> Rule:
        consequents = tuple(self._named(key, consequent) for consequent in rule.consequents)
        antecedent = self._antecedent(key, rule.antecedent)
        return Rule(antecedent, consequents, rule.weight, in_grid=rule.in_grid)

    def _antecedent(self, key: str, expression: Expression) -> Expression:
        match expression:
            case Is():
                return self._named(key, expression)
            case Hedged(operand=operand):
                return replace(expression, operand=self._antecedent(key, operand))
            case And(operands=operands) | Or(operands=operands):
                joint = tuple(self._antecedent(key, operand) for operand in operands)
                return replace(expression, operands=joint)

    def _named(self, key: str, part: _Part) -> _Part:
        """Return a proposition or conclusion under the joint names."""
        shared = self.root(key, part.variable)
        term = shared.renamed[key, part.variable, part.term]
        return replace(part, variable=shared.name, term=term)

    def _note_left_out(self, part: RuleBase) -> None:
        lines = len(part.expectations) + len(part.properties)
        if lines or part.lookup is not None or part.tuning is not None:
            message = f"the expectations, properties and settings of '{part.name}' are left out"
            self.findings.info("dropped-expectations", message)


def _variables(part: RuleBase) -> list[Input | Output]:
    return [*part.inputs, *part.outputs]


def _range(variable: Input | Output) -> str:
    return f"{number_text(variable.low)} .. {number_text(variable.high)}"
