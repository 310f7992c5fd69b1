"""Which methods a file uses, with their publications: norms, sets, defuzzifiers, structures."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzyarm.language.model.controller import Axes, ControllerModel, SignalLine
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, model_of
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SNORMS, TNORMS

RULES_OVER_SETS = ("mamdani1975",)
"""Rules with clipped and united sets as conclusions."""

SELF_TUNING = ("mudi1999",)
"""Rules whose output is scaled by other rules over the same inputs."""


def methods_of(rulebase: AnyRuleBase) -> dict[str, list[str]]:
    """Return the publications of the methods of a rule base, with the methods of each.

    Parameters
    ----------
    rulebase : RuleBase or RuleBaseBuilder
        Any.

    Returns
    -------
    dict of str to list of str
        Keys of :data:`fuzzyarm.base.sources.SOURCES` to names of methods, in order of appearance.
        Methods without a publication there are omitted.

    Examples
    --------
    >>> import fuzzyarm
    >>> rulebase = fuzzyarm.load_rulebase(fuzzyarm.shipped("pd7.frb"))
    >>> methods_of(rulebase)
    {'mamdani1975': ['rules over sets'], 'zadeh1965': ['and min', 'aggregation max']}
    """
    methods: dict[str, list[str]] = {}
    for sources, name in _methods(model_of(rulebase)):
        for source in sources:
            if name not in methods.setdefault(source, []):
                methods[source].append(name)
    return methods


def _methods(rulebase: RuleBase) -> Iterator[tuple[tuple[str, ...], str]]:
    outputs = [(output, DEFUZZIFIERS[output.defuzzifier.method]) for output in rulebase.outputs]
    sets = [output for output, kind in outputs if not kind.weighs]
    if sets:
        yield RULES_OVER_SETS, "rules over sets"
    for block in rulebase.blocks:
        yield TNORMS[block.conjunction].sources, f"and {block.conjunction}"
    for output in sets:
        yield SNORMS[output.aggregation].sources, f"aggregation {output.aggregation}"
    for _, kind in outputs:
        yield kind.sources, f"defuzzifier {kind.name}"


def structures_of(controller: ControllerModel) -> dict[str, list[str]]:
    """Return the publications of how a controller is put together, as `methods_of`.

    Parameters
    ----------
    controller : ControllerModel
        Any. Only structures evident from its lines count.

    Returns
    -------
    dict of str to list of str
        Keys of :data:`fuzzyarm.base.sources.SOURCES` to names of structures.
    """
    if any(map(_tunes_itself, controller.axes)):
        return {key: ["self-tuning"] for key in SELF_TUNING}
    return {}


def _tunes_itself(axes: Axes) -> bool:
    """Whether the output of rules is multiplied by one of other rules over the same inputs."""
    settings = [
        line
        for line in axes.lines
        if isinstance(line, SignalLine) and line.source is not None and line.source.kind == "rules"
    ]
    inputs = {
        name: line.source.inputs
        for line in settings
        if line.source is not None
        for name in line.names
    }
    return any(
        inputs.get(str(factor.value)) == line.source.inputs and not factor.divides
        for line in settings
        if line.source is not None
        for product in line.products
        for factor in product.factors
    )
