"""The PD-type rule base of the thesis (Table 6.4.1), built in Python."""

from __future__ import annotations

from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)

NAMES = ("NB", "NM", "NS", "ZE", "PS", "PM", "PB")

TABLE = """
    NB NB NB NM NS NS ZE
    NB NM NM NM NS ZE PS
    NB NM NS NS ZE PS PM
    NB NM NS ZE PS PM PB
    NM NS ZE PS PS PM PB
    NS ZE PS PM PM PM PB
    ZE PS PS PM PB PB PB
"""


def make_pd7(**output_settings: object) -> RuleBase:
    """Rows e, columns ce; seven triangles with peaks every 2 on −6 … 6."""
    terms = tuple(
        Term(name, Shape("triangle", (peak - 2.0, peak, peak + 2.0)))
        for name, peak in zip(NAMES, range(-6, 7, 2), strict=True)
    )
    rows = [line.split() for line in TABLE.strip().splitlines()]
    rules = tuple(
        Rule(
            And((Is("e", row), Is("ce", column))),
            (Consequent("u", rows[i][j]),),
            in_grid=True,
        )
        for i, row in enumerate(NAMES)
        for j, column in enumerate(NAMES)
    )
    return RuleBase(
        "pd7",
        inputs=(Input("e", -6.0, 6.0, terms), Input("ce", -6.0, 6.0, terms)),
        outputs=(Output("u", -6.0, 6.0, terms, **output_settings),),  # type: ignore[arg-type]
        blocks=(RuleBlock(rules),),
    )
