"""Turn a syntax tree into a RuleBase, as far as its statements are sound.

:func:`elaborate` walks the statements and judges the whole: declarations are in
:mod:`fuzzyarm.language.declarations`, rules in :mod:`fuzzyarm.language.rule_meaning`,
expectations, properties, lookup and tuning in :mod:`fuzzyarm.language.demands`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TypeVar

from fuzzyarm.base.diagnostic import (
    MAX_DIAGNOSTICS,
    MAX_RULES,
    NOWHERE,
    Diagnostic,
    Related,
    Severity,
    Span,
    Word,
)
from fuzzyarm.language.declarations import (
    Draft,
    Norms,
    Scope,
    add_even_terms,
    add_term,
    apply_inference,
    block_norms,
    declare_variable,
    range_of,
)
from fuzzyarm.language.demands import (
    elaborate_expectation,
    elaborate_lookup,
    elaborate_property,
    elaborate_tuning,
)
from fuzzyarm.language.document import Document, ParseMemory
from fuzzyarm.language.model.rulebase import (
    Expectation,
    Input,
    Lookup,
    Output,
    Property,
    Rule,
    RuleBase,
    RuleBlock,
    Tuning,
    last_conclusions,
    propositions,
    without_range,
)
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.rows import mentions
from fuzzyarm.language.rule_meaning import elaborate_grid, elaborate_rule, report_too_many
from fuzzyarm.language.rules import GridNode, RuleNode
from fuzzyarm.language.statements import (
    BlockNode,
    Broken,
    EvenTermsNode,
    ExpectNode,
    Heading,
    InferenceNode,
    LookupNode,
    ProveNode,
    StatementNode,
    TermNode,
    VariableNode,
)
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.tune import TuneNode

UNNAMED = "unnamed"


def elaborate(
    document: Document, memory: ParseMemory | None = None
) -> tuple[RuleBase, list[Diagnostic]]:
    """Return the rule base of `document`, with the findings.

    Statements may be in any order; a faulty one is left out, so the result is complete only without
    errors. With a `memory`, unchanged rules are not checked again.
    """
    memory = memory or ParseMemory()
    scope = Scope()
    nodes = [statement.node for statement in document.statements]
    scope.broken_variables = any(
        isinstance(node, Broken) and node.keyword in ("input", "output") for node in nodes
    )
    for node in nodes:
        if isinstance(node, VariableNode):
            declare_variable(node, scope)
    # Without any declaration, the names in rules count as declared: a missing line is one finding,
    # not one in each rule.
    for role in ("input", "output"):
        if not scope.names(role) and not scope.broken_variables:
            scope.presumed |= _presumed(nodes, role)
    for node in nodes:
        if scope.overflows:
            break
        if isinstance(node, TermNode):
            add_term(node, scope)
        elif isinstance(node, EvenTermsNode):
            add_even_terms(node, scope)
    norms = _settings(nodes, scope)
    memory.enter_scope(_identity(scope))
    for statement in document.statements:
        _judge_names(statement.names, scope)
    blocks = _blocks(nodes, scope, norms, memory)
    heading = _single(nodes, Heading, "heading", scope)
    rulebase = RuleBase(
        name=str(heading.name) if heading else UNNAMED,
        inputs=tuple(_input(d) for d in scope.drafts.values() if d.is_input),
        outputs=tuple(_output(d) for d in scope.drafts.values() if not d.is_input),
        blocks=blocks,
        description=str(heading.description or "") if heading else "",
        lookup=_lookup(nodes, scope),
        expectations=_expectations(nodes, scope),
        properties=_properties(nodes, scope),
        tuning=_tuning(nodes, scope),
    )
    _judge_whole(rulebase, nodes, scope)
    return rulebase, scope.diagnostics


def _judge_names(names: Iterable[Occurrence], scope: Scope) -> None:
    """Report unknown names in the unreadable part of a statement."""
    for name in names:
        word = Word(name.name, name.span)
        if name.is_definition:
            continue
        if name.kind is NameKind.VARIABLE:
            scope.variable(word)
        elif name.kind is NameKind.TERM:
            scope.term(scope.drafts.get(name.owners[0]), word)


def judge_statement(node: StatementNode, scope: Scope) -> None:
    """Add one statement to `scope`, after those before, and report its faults.

    For a rule base built statement by statement: the findings of :func:`elaborate` at this point,
    except those that need the whole file.
    """
    if isinstance(node, VariableNode):
        declare_variable(node, scope)
    elif isinstance(node, TermNode):
        add_term(node, scope)
    elif isinstance(node, EvenTermsNode):
        add_even_terms(node, scope)
    elif isinstance(node, InferenceNode):
        apply_inference(node, scope, {})
    elif isinstance(node, BlockNode):
        block_norms(node, scope, {})
    elif isinstance(node, RuleNode | GridNode):
        _rules_of(node, scope, MAX_RULES, ParseMemory())
    elif isinstance(node, LookupNode):
        elaborate_lookup(node, scope)
    elif isinstance(node, ExpectNode):
        elaborate_expectation(node, scope)
    elif isinstance(node, ProveNode):
        elaborate_property(node, scope)


def _presumed(nodes: list[StatementNode], role: str) -> frozenset[str]:
    """Return the names that rules use as the inputs or outputs of the file."""
    outputs: set[str] = set()
    every: set[str] = set()
    for node in nodes:
        if isinstance(node, GridNode):
            outputs.update(part.output for part in node.parts)
        elif isinstance(node, RuleNode):
            outputs.update(consequent.variable for consequent in node.consequents)
        else:
            continue
        every.update(
            mention.name for mention in mentions(node) if mention.kind is NameKind.VARIABLE
        )
    return frozenset(outputs if role == "output" else every - outputs)


def _settings(nodes: list[StatementNode], scope: Scope) -> Norms:
    norms: Norms = {}
    lines = [node for node in nodes if isinstance(node, InferenceNode)]
    # Lines for all variables first, so that those for one variable override them.
    for node in sorted(lines, key=lambda line: line.target is not None):
        apply_inference(node, scope, norms)
    return norms


def _blocks(
    nodes: list[StatementNode], scope: Scope, norms: Norms, memory: ParseMemory
) -> tuple[RuleBlock, ...]:
    blocks: list[RuleBlock] = []
    rules: list[Rule] = []
    name, block_settings = "", norms
    first_spans: dict[str, Span] = {}
    budget = MAX_RULES
    for node in nodes:
        if isinstance(node, BlockNode):
            if rules or name:
                blocks.append(RuleBlock(tuple(rules), name, **block_settings))
            if node.name in first_spans:
                scope.report(
                    "duplicate-block",
                    f"two blocks are called '{node.name}'",
                    node.name.span,
                    related=(Related("first here", first_spans[node.name]),),
                )
            first_spans[node.name] = node.name.span
            rules, name, block_settings = [], str(node.name), block_norms(node, scope, norms)
        elif isinstance(node, RuleNode | GridNode):
            if budget < 0 or scope.overflows:
                continue
            block_rules = _rules_of(node, scope, budget, memory)
            budget -= len(block_rules)
            if budget < 0:
                report_too_many(node.span, scope)
            rules += block_rules
    if rules or name:
        blocks.append(RuleBlock(tuple(rules), name, **block_settings))
    return tuple(blocks)


def _identity(scope: Scope) -> Hashable:
    """Return everything on which the meaning of a rule depends besides its own words."""
    drafts = scope.drafts.values()
    variables = tuple((d.name, d.is_input, d.node.name.span, *d.terms.values()) for d in drafts)
    return scope.broken_variables, variables


def _rules_of(
    node: RuleNode | GridNode, scope: Scope, budget: int, memory: ParseMemory
) -> list[Rule]:
    earlier = memory.recall_rules(node)
    if earlier is not None and len(earlier[0]) <= budget:
        scope.diagnostics += earlier[1]
        return earlier[0]
    before = len(scope.diagnostics)
    if isinstance(node, RuleNode):
        rules = elaborate_rule(node, scope)
    else:
        rules = [rule for part in node.parts for rule in elaborate_grid(part, scope, budget)]
    if not scope.overflows:  # otherwise it may have been abandoned half-way
        memory.keep_rules(node, rules, scope.diagnostics[before:])
    return rules


def _lookup(nodes: list[StatementNode], scope: Scope) -> Lookup | None:
    node = _single(nodes, LookupNode, "lookup block", scope)
    return elaborate_lookup(node, scope) if node else None


def _tuning(nodes: list[StatementNode], scope: Scope) -> Tuning | None:
    node = _single(nodes, TuneNode, "tune block", scope)
    return elaborate_tuning(node, scope) if node else None


def _expectations(nodes: list[StatementNode], scope: Scope) -> tuple[Expectation, ...]:
    expectations = [
        elaborate_expectation(n, scope)
        for n in nodes
        if isinstance(n, ExpectNode) and not scope.overflows
    ]
    return tuple(expectation for expectation in expectations if expectation is not None)


def _properties(nodes: list[StatementNode], scope: Scope) -> tuple[Property, ...]:
    properties = [
        elaborate_property(n, scope)
        for n in nodes
        if isinstance(n, ProveNode) and not scope.overflows
    ]
    return tuple(proof for proof in properties if proof is not None)


_Node = TypeVar("_Node", bound=StatementNode)


def _single(nodes: list[StatementNode], kind: type[_Node], what: str, scope: Scope) -> _Node | None:
    matches = [node for node in nodes if isinstance(node, kind)]
    for extra in matches[1:MAX_DIAGNOSTICS]:
        scope.report(
            "duplicate-statement",
            f"a file has only one {what}",
            extra.span,
            related=(Related("first here", matches[0].span),),
        )
    return matches[0] if matches else None


def _input(draft: Draft) -> Input:
    node = draft.node
    return Input(
        draft.name,
        *range_of(node),
        tuple(draft.terms.values()),
        str(node.description or ""),
        draft.outside,
        node.name.span,
    )


def _output(draft: Draft) -> Output:
    node = draft.node
    return Output(
        draft.name,
        *range_of(node),
        tuple(draft.terms.values()),
        str(node.description or ""),
        draft.outside,
        node.name.span,
        draft.aggregation,
        draft.defuzzifier,
        draft.no_rule,
    )


def _judge_whole(rulebase: RuleBase, nodes: list[StatementNode], scope: Scope) -> None:
    broken = {node.keyword for node in nodes if isinstance(node, Broken)}
    if not any(isinstance(node, Heading) for node in nodes) and "rulebase" not in broken:
        scope.report(
            "missing-heading",
            "the file does not say what it contains",
            nodes[0].span if nodes else NOWHERE,
            hint='start it with  rulebase NAME "what it is for"'
            + ("" if nodes else " , or with  controller NAME"),
            severity=Severity.WARNING,
        )
    _judge_missing(rulebase, nodes, broken, scope)
    _judge_chain(rulebase, scope)
    for output in without_range(rulebase):
        node = scope.drafts[output.name].node
        if node.low is not None and node.high is not None:
            message = f"the output '{output.name}' needs a finite range to be integrated over"
            scope.report("bad-range", message, node.low.span.to(node.high.span))


def _judge_missing(
    rulebase: RuleBase, nodes: list[StatementNode], broken: set[str], scope: Scope
) -> None:
    """Demand inputs, outputs and rules, unless some are unreadable."""
    end = nodes[-1].span if nodes else NOWHERE
    for what, count in (("input", len(rulebase.inputs)), ("output", len(rulebase.outputs))):
        if count == 0 and what not in broken:
            uses = [
                mention
                for node in nodes
                for mention in mentions(node)
                if mention.kind is NameKind.VARIABLE and mention.name in _presumed(nodes, what)
            ]
            first = min(uses, key=lambda mention: mention.span, default=None)
            scope.report(
                f"no-{what}s",
                f"the file declares no {what}",
                end if first is None else first.span,
                hint=f"declare it with  {what} {name_text(first.name)} LOW .. HIGH"
                if first
                else "",
            )
    has_rules = any(isinstance(node, RuleNode | GridNode) for node in nodes)
    if not has_rules and not broken & {"rule", "rules"}:
        scope.report("no-rules", "the file has no rules", end)


def _judge_chain(rulebase: RuleBase, scope: Scope) -> None:
    """Demand that an output used as an input is complete before the block that uses it."""
    outputs = {output.name for output in rulebase.outputs}
    last = last_conclusions(rulebase)
    for index, block in enumerate(rulebase.blocks):
        for rule in block.rules:
            for proposition in propositions(rule.antecedent):
                name = proposition.variable
                if name not in outputs:
                    continue
                if name not in last:
                    scope.report(
                        "unassigned-output",
                        f"the output '{name}' is used here, but no rule sets it",
                        proposition.span,
                    )
                elif last[name] >= index:
                    scope.report(
                        "cyclic-blocks",
                        f"the output '{name}' is used here, but rules set it in this block"
                        " or a later one",
                        proposition.span,
                        hint="put the rule into a block after those that set the output",
                    )
