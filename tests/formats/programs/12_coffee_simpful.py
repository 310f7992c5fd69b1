import simpful as sf

FS = sf.FuzzySystem()
strength = sf.AutoTriangle(3, terms=["mild", "fair", "strong"], universe_of_discourse=[0, 10])
hour = sf.LinguisticVariable(
    [sf.TrapezoidFuzzySet(0, 0, 8, 12, "morning"), sf.TrapezoidFuzzySet(8, 14, 24, 24, "late")],
    concept="hour of the day", universe_of_discourse=[0, 24],
)
FS.add_linguistic_variable("strength", strength)
FS.add_linguistic_variable("hour", hour)
FS.add_linguistic_variable("cups", sf.LinguisticVariable(
    [sf.TriangleFuzzySet(0, 0, 2, "few"), sf.TriangleFuzzySet(1, 4, 4, "many")],
    universe_of_discourse=[0, 4],
))
FS.add_rules([
    "IF (hour IS morning) AND (strength IS mild) THEN (cups IS many)",
    "IF (hour IS late) OR (strength IS strong) THEN (cups IS few)",
])
FS.set_variable("strength", float(input("strength of the coffee: ")))
FS.set_variable("hour", 9)
print(FS.Mamdani_inference(["cups"]))
FS.produce_figure(outputfile="figures/coffee.pdf")
