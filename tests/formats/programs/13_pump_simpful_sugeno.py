from simpful import FuzzySet, FuzzySystem, LinguisticVariable

FS = FuzzySystem(show_banner=False)
low = FuzzySet(points=[[0, 1], [5, 0]], term="low")
high = FuzzySet(points=[[0, 0], [5, 1], [10, 1]], term="high")
FS.add_linguistic_variable("level", LinguisticVariable([low, high], universe_of_discourse=[0, 10]))
FS.add_linguistic_variable("flow", LinguisticVariable([low, high], universe_of_discourse=[0, 10]))
FS.set_crisp_output_value("off", 0)
FS.set_output_function("follow", "2 * flow + 0.5 * level + 1")
FS.add_rules([
    "IF (level IS low) THEN (pump IS off)",
    "IF (level IS high) AND (flow IS low) THEN (pump IS follow)",
    "IF (level IS high) AND (flow IS high) THEN (pump IS follow) WEIGHT 0.8",
])
FS.set_variable("level", 4)
FS.set_variable("flow", 6)
print(FS.Sugeno_inference(["pump"]))
