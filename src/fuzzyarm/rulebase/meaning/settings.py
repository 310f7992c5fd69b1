"""Apply ``inference`` and ``block`` settings."""

from __future__ import annotations

from typing import TypedDict

from fuzzyarm.rulebase.meaning.scope import Draft, Scope
from fuzzyarm.rulebase.model import Defuzzifier
from fuzzyarm.rulebase.syntax.nodes import BlockNode, InferenceNode, SettingNode

BLOCK_KEYS = ("and", "or", "implication", "threshold")
"""Settings that belong to rules; all others belong to variables."""

_MAX_SAMPLES = 1_000_000


class Norms(TypedDict, total=False):
    """What a block of rules is evaluated by; see RuleBlock."""

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
        if setting.key.text in BLOCK_KEYS:
            if node.target is not None:
                scope.report(
                    "misplaced-setting",
                    f"'{setting.key.text}' belongs to rules, not to the variable"
                    f" '{node.target.text}'",
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
    own = norms.copy()
    _report_repeated(node.settings, scope)
    for setting in node.settings:
        if setting.key.text in BLOCK_KEYS:
            _set_norm(setting, scope, own)
        else:
            scope.report(
                "misplaced-setting",
                f"'{setting.key.text}' belongs to an output, not to a block",
                setting.key.span,
                hint="write it on an inference line",
            )
    return own


def _set_norm(setting: SettingNode, scope: Scope, norms: Norms) -> None:
    if setting.figure is not None:
        if not 0.0 <= setting.figure.value < 1.0:
            scope.report(
                "bad-threshold", "a threshold must be at least 0 and below 1", setting.figure.span
            )
        norms["threshold"] = setting.figure.value
    elif setting.value is not None:
        key = setting.key.text
        if key == "and":
            norms["conjunction"] = setting.value.text
        elif key == "or":
            norms["disjunction"] = setting.value.text
        else:
            norms["implication"] = setting.value.text


def _report_repeated(settings: tuple[SettingNode, ...], scope: Scope) -> None:
    seen: set[str] = set()
    for setting in settings:
        if setting.key.text in seen:
            scope.report(
                "duplicate-setting", f"'{setting.key.text}' is set twice", setting.key.span
            )
        seen.add(setting.key.text)


def _apply(setting: SettingNode, draft: Draft, scope: Scope, *, named: bool) -> None:
    key = setting.key.text
    if key == "outside":
        assert setting.value is not None
        draft.outside = setting.value.text
    elif draft.is_input:
        if named:
            scope.report(
                "misplaced-setting",
                f"'{key}' belongs to an output; '{draft.name}' is an input",
                setting.key.span,
            )
    elif key == "aggregation":
        assert setting.value is not None
        draft.aggregation = setting.value.text
    elif key == "no-rule":
        if setting.value is not None:
            draft.no_rule = setting.value.text
        elif setting.figure is not None:
            draft.no_rule = setting.figure.value
    else:
        draft.defuzzifier = _defuzzifier(setting, scope)


def _defuzzifier(setting: SettingNode, scope: Scope) -> Defuzzifier:
    assert setting.value is not None
    method = setting.value.text
    if setting.resolution is None:
        return Defuzzifier(method)
    samples = setting.resolution.value
    if method in ("weighted-average", "weighted-sum", "tsukamoto"):
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
    sampling = setting.sampling.text if setting.sampling else "endpoints"
    return Defuzzifier(method, int(samples), sampling)
