"""How far to close the blinds, with pyfuzzylite."""

import fuzzylite as fl

engine = fl.Engine(
    name="blinds",
    input_variables=[
        fl.InputVariable(
            name="sun",
            minimum=0,
            maximum=1000,
            lock_range=True,
            terms=[
                fl.Ramp("weak", 400, 100),
                fl.Triangle("middle", 200, 450, 700),
                fl.Sigmoid("strong", 600, 0.02),
            ],
        ),
        fl.InputVariable(
            name="room",
            minimum=15,
            maximum=30,
            lock_range=True,
            terms=[fl.Gaussian("cool", 18, 2), fl.Gaussian("hot", 26, 2.5)],
        ),
    ],
    output_variables=[
        fl.OutputVariable(
            name="closed",
            minimum=0,
            maximum=100,
            default_value=0,
            aggregation=fl.Maximum(),
            defuzzifier=fl.Centroid(200),
            terms=[
                fl.Triangle("open", -50, 0, 50),
                fl.Triangle("half", 25, 50, 75),
                fl.Triangle("shut", 50, 100, 150),
            ],
        )
    ],
    rule_blocks=[
        fl.RuleBlock(
            conjunction=fl.Minimum(),
            disjunction=fl.Maximum(),
            implication=fl.Minimum(),
            activation=fl.General(),
            rules=[
                fl.Rule.create("if sun is weak or room is cool then closed is open"),
                fl.Rule.create("if sun is middle and room is hot then closed is half"),
                fl.Rule.create("if sun is strong and room is not cool then closed is shut"),
            ],
        )
    ],
)

engine.input_variables[0].value = 800
engine.input_variables[1].value = 27
engine.process()
print(engine.output_variables[0].value)
