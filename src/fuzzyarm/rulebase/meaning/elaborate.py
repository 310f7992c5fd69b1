"""Turn a syntax tree into a RuleBase, as far as its statements are sound."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TypeVar

from fuzzyarm.rulebase.diagnostic import NOWHERE, Diagnostic, Related, Severity, Span
from fuzzyarm.rulebase.limits import MAX_DIAGNOSTICS, MAX_RULES
from fuzzyarm.rulebase.meaning.expectations import elaborate_expectation
from fuzzyarm.rulebase.meaning.lookup import elaborate_lookup
from fuzzyarm.rulebase.meaning.rules import elaborate_grid, elaborate_rule, report_too_many
from fuzzyarm.rulebase.meaning.scope import Draft, Scope
from fuzzyarm.rulebase.meaning.settings import Norms, apply_inference, block_norms
from fuzzyarm.rulebase.meaning.variables import (
    add_even_terms,
    add_term,
    declare_variable,
    range_of,
)
from fuzzyarm.rulebase.model import (
    Expectation,
    Input,
    Lookup,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    propositions,
)
from fuzzyarm.rulebase.syntax.memory import ParseMemory
from fuzzyarm.rulebase.syntax.nodes import (
    BlockNode,
    Broken,
    Document,
    EvenTermsNode,
    ExpectNode,
    GridNode,
    Heading,
    InferenceNode,
    LookupNode,
    RuleNode,
    StatementNode,
    TermNode,
    VariableNode,
)

UNNAMED = "unnamed"


def elaborate(
    document: Document, memory: ParseMemory | None = None
) -> tuple[RuleBase, list[Diagnostic]]:
    """Return the rule base that `document` means, and what is wrong with it.

    Statements may stand in any order; where one is at fault it is left out, so the result
    is complete only if no diagnostic is an error. With a `memory`, rules that stand as they
    stood are not judged again.
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
    for node in nodes:
        if scope.overflows:
            break
        if isinstance(node, TermNode):
            add_term(node, scope)
        elif isinstance(node, EvenTermsNode):
            add_even_terms(node, scope)
    norms = _settings(nodes, scope)
    memory.enter_scope(_identity(scope))
    blocks = _blocks(nodes, scope, norms, memory)
    heading = _single(nodes, Heading, "heading", scope)
    rulebase = RuleBase(
        name=heading.name.text if heading else UNNAMED,
        inputs=tuple(_input(d) for d in scope.drafts.values() if d.is_input),
        outputs=tuple(_output(d) for d in scope.drafts.values() if not d.is_input),
        blocks=blocks,
        description=(heading.description or "") if heading else "",
        lookup=_lookup(nodes, scope),
        expectations=_expectations(nodes, scope),
    )
    _judge_whole(rulebase, nodes, scope)
    return rulebase, scope.diagnostics


def _settings(nodes: list[StatementNode], scope: Scope) -> Norms:
    norms: Norms = {}
    lines = [node for node in nodes if isinstance(node, InferenceNode)]
    for node in sorted(lines, key=lambda line: line.target is not None):
        apply_inference(node, scope, norms)
    return norms


def _blocks(
    nodes: list[StatementNode], scope: Scope, norms: Norms, memory: ParseMemory
) -> tuple[RuleBlock, ...]:
    blocks: list[RuleBlock] = []
    rules: list[Rule] = []
    name, own = "", norms
    places: dict[str, Span] = {}
    budget = MAX_RULES
    for node in nodes:
        if isinstance(node, BlockNode):
            if rules or name:
                blocks.append(RuleBlock(tuple(rules), name, **own))
            if node.name.text in places:
                scope.report(
                    "duplicate-block",
                    f"two blocks are called '{node.name.text}'",
                    node.name.span,
                    related=(Related("first here", places[node.name.text]),),
                )
            places[node.name.text] = node.name.span
            rules, name, own = [], node.name.text, block_norms(node, scope, norms)
        elif isinstance(node, RuleNode | GridNode):
            if budget < 0 or scope.overflows:
                continue
            found = _rules_of(node, scope, budget, memory)
            budget -= len(found)
            if budget < 0:
                report_too_many(node.span, scope)
            rules += found
    if rules or name:
        blocks.append(RuleBlock(tuple(rules), name, **own))
    return tuple(blocks)


def _identity(scope: Scope) -> Hashable:
    """Return everything that the meaning of a rule depends on besides its own words."""
    drafts = scope.drafts.values()
    variables = tuple((d.name, d.is_input, d.node.name.span, *d.terms.values()) for d in drafts)
    return scope.broken_variables, variables


def _rules_of(
    node: RuleNode | GridNode, scope: Scope, budget: int, memory: ParseMemory
) -> list[Rule]:
    known = memory.recall_rules(node)
    if known is not None and len(known[0]) <= budget:
        scope.diagnostics += known[1]
        return known[0]
    before = len(scope.diagnostics)
    if isinstance(node, RuleNode):
        found = elaborate_rule(node, scope)
    else:
        found = elaborate_grid(node, scope, budget)
    if not scope.overflows:  # else it may have been given up half-way
        memory.keep_rules(node, found, scope.diagnostics[before:])
    return found


def _lookup(nodes: list[StatementNode], scope: Scope) -> Lookup | None:
    node = _single(nodes, LookupNode, "lookup block", scope)
    return elaborate_lookup(node, scope) if node else None


def _expectations(nodes: list[StatementNode], scope: Scope) -> tuple[Expectation, ...]:
    found = [
        elaborate_expectation(n, scope)
        for n in nodes
        if isinstance(n, ExpectNode) and not scope.overflows
    ]
    return tuple(expectation for expectation in found if expectation is not None)


_Node = TypeVar("_Node", bound=StatementNode)


def _single(nodes: list[StatementNode], kind: type[_Node], what: str, scope: Scope) -> _Node | None:
    found = [node for node in nodes if isinstance(node, kind)]
    for extra in found[1:MAX_DIAGNOSTICS]:
        scope.report(
            "duplicate-statement",
            f"a file has one {what} only",
            extra.span,
            related=(Related("first here", found[0].span),),
        )
    return found[0] if found else None


def _input(draft: Draft) -> Input:
    node = draft.node
    return Input(
        draft.name,
        *range_of(node),
        tuple(draft.terms.values()),
        node.description or "",
        draft.outside,
        node.name.span,
    )


def _output(draft: Draft) -> Output:
    node = draft.node
    return Output(
        draft.name,
        *range_of(node),
        tuple(draft.terms.values()),
        node.description or "",
        draft.outside,
        node.name.span,
        draft.aggregation,
        draft.defuzzifier,
        draft.no_rule,
    )


def _judge_whole(rulebase: RuleBase, nodes: list[StatementNode], scope: Scope) -> None:
    broken = {node.keyword for node in nodes if isinstance(node, Broken)}
    end = nodes[-1].span if nodes else NOWHERE
    if not any(isinstance(node, Heading) for node in nodes) and "rulebase" not in broken:
        scope.report(
            "missing-heading",
            "the file does not say what it is",
            nodes[0].span if nodes else NOWHERE,
            hint='start it with  rulebase NAME "what it is for"',
            severity=Severity.WARNING,
        )
    for what, count in (("input", len(rulebase.inputs)), ("output", len(rulebase.outputs))):
        if count == 0 and what not in broken:
            scope.report(f"no-{what}s", f"the file declares no {what}", end)
    has_rules = any(isinstance(node, RuleNode | GridNode) for node in nodes)
    if not has_rules and not broken & {"rule", "rules"}:
        scope.report("no-rules", "the file has no rules", end)
    _judge_chain(rulebase, scope)


def _judge_chain(rulebase: RuleBase, scope: Scope) -> None:
    """Demand that an output used as an input is complete before the block that uses it."""
    outputs = {output.name for output in rulebase.outputs}
    last_writer: dict[str, int] = {}
    for index, block in enumerate(rulebase.blocks):
        for rule in block.rules:
            for consequent in rule.consequents:
                last_writer[consequent.variable] = index
    for index, block in enumerate(rulebase.blocks):
        for rule in block.rules:
            for proposition in propositions(rule.antecedent):
                name = proposition.variable
                if name not in outputs:
                    continue
                if name not in last_writer:
                    scope.report(
                        "unassigned-output",
                        f"the output '{name}' is asked for here, but no rule sets it",
                        proposition.span,
                    )
                elif last_writer[name] >= index:
                    scope.report(
                        "cyclic-blocks",
                        f"the output '{name}' is asked for here, but rules set it in this block"
                        " or a later one",
                        proposition.span,
                        hint="rules that use an output stand in a block after those that set it",
                    )
