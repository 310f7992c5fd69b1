import simpful as sf

FS = sf.FuzzySystem(show_banner=False)
FS.add_linguistic_variable("x", sf.AutoTriangle(2, terms=["a", "b"], universe_of_discourse=[0, 1]))
FS.add_linguistic_variable("y", sf.AutoTriangle(2, terms=["c", "d"], universe_of_discourse=[0, 1]))
FS.add_rules(["IF (x IS a) THEN (y IS c)"])
rules = open("rules.txt").read().splitlines()
FS.add_rules(rules)
print(FS.inference())
