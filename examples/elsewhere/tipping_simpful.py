"""How much to tip, with simpful: Sugeno's method, one of its values a function of the inputs."""

import simpful as sf

tipping = sf.FuzzySystem(show_banner=False)

tipping.add_linguistic_variable(
    "service",
    sf.LinguisticVariable(
        [
            sf.FuzzySet(points=[[0, 1], [5, 0]], term="poor"),
            sf.FuzzySet(points=[[0, 0], [5, 1], [10, 0]], term="good"),
            sf.FuzzySet(points=[[5, 0], [10, 1]], term="excellent"),
        ],
        universe_of_discourse=[0, 10],
    ),
)
tipping.add_linguistic_variable(
    "food",
    sf.LinguisticVariable(
        [
            sf.TriangleFuzzySet(0, 0, 10, term="rancid"),
            sf.GaussianFuzzySet(10, 3, term="delicious"),
        ],
        concept="quality of the food",
        universe_of_discourse=[0, 10],
    ),
)

tipping.set_crisp_output_value("small", 5)
tipping.set_crisp_output_value("average", 15)
tipping.set_output_function("generous", "food + service + 5")

tipping.add_rules(
    [
        "IF (service IS poor) OR (food IS rancid) THEN (tip IS small)",
        "IF (service IS good) THEN (tip IS average)",
        "IF (service IS excellent) OR (food IS delicious) THEN (tip IS generous)",
    ]
)

tipping.set_variable("service", 4)
tipping.set_variable("food", 8)
print(tipping.inference(["tip"]))
