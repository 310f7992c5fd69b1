"""Random rule bases that the control kernel can evaluate."""

from hypothesis import strategies as st

from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Hedge,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)

NUMBER = st.integers(-24, 24).map(lambda k: k / 4)


@st.composite
def shapes(draw):
    kind = draw(st.sampled_from(["triangle", "trapezoid", "rectangle", "ramp"]))
    count = {"triangle": 3, "trapezoid": 4, "rectangle": 2, "ramp": 2}[kind]
    corners = sorted(draw(st.lists(NUMBER, min_size=count, max_size=count, unique=True)))
    if kind == "ramp" and draw(st.booleans()):
        corners.reverse()
    return Shape(kind, tuple(corners), draw(st.sampled_from([1.0, 1.0, 0.75])))


@st.composite
def term_lists(draw):
    count = draw(st.integers(1, 5))
    return tuple(Term(f"T{k}", draw(shapes())) for k in range(count))


@st.composite
def rule_bases(draw):
    names = draw(st.sampled_from([("e",), ("e", "ce"), ("ce", "e"), ("e", "ce", "joint")]))
    inputs = tuple(Input(name, -6.0, 6.0, draw(term_lists())) for name in names)
    resolution = draw(st.sampled_from([None, None, 11, 101]))
    sampling = draw(st.sampled_from(["endpoints", "midpoints", "left", "trapezoid"]))
    output = Output(
        "u",
        -6.0,
        6.0,
        draw(term_lists()),
        defuzzifier=Defuzzifier("centroid", resolution, sampling),
        no_rule=0.25,
    )
    hedges = st.sampled_from([(), (), (Hedge("not"),)])

    def proposition(variable):
        term = draw(st.sampled_from(variable.terms))
        return Is(variable.name, term.name, draw(hedges))

    rules = []
    for _ in range(draw(st.integers(1, 8))):
        chosen = draw(st.lists(st.sampled_from(inputs), min_size=1, max_size=3))
        parts = [proposition(variable) for variable in chosen]
        antecedent = parts[0] if len(parts) == 1 else And(tuple(parts))
        consequent = Consequent("u", draw(st.sampled_from(output.terms)).name)
        weight = draw(st.sampled_from([1.0, 1.0, 0.5]))
        rules.append(Rule(antecedent, (consequent,), weight))
    conjunction, implication = draw(st.sampled_from([("min", "min"), ("product", "product")]))
    block = RuleBlock(
        tuple(rules),
        conjunction=conjunction,
        implication=implication,
        threshold=draw(st.sampled_from([0.0, 0.0, 0.1])),
    )
    return RuleBase("random", inputs, (output,), (block,))
