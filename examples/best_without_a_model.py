"""Rules against straight lines: controllers without a model of the arm, and where they end.

All of them drive the same motors at the same 20 V, and follow the same set points, which stand for
five control periods; errors are those at the set points, in the last of the five, and those from
the path on which the set points lie. `fuzzy-fine` is 49 rules on the error and its rate; `pd-motor`
a straight line in their place, `pd-motor-tuned` one with tuned gains. `fuzzy-smooth` and
`pid-smooth` average the set points first, then there are seven rules or a straight line, and an
integral.
"""

from fuzzyarm.apps.study import NAMES, run_beyond
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import pick_and_place, reach_return, through

beyond = {each.name: each for each in run_beyond()}
best = beyond["fuzzy-fine"]
rows = {name: each.rms for name, each in beyond.items()}
rows |= {"best published": best.best_of_all, "without a model": best.best_without_model}
print("RMS errors under the conditions of the study's summary table, degrees: at the set points")
for name, figures in rows.items():
    print(f"{name:<16}" + "".join(f"{value:9.4f}" for value in figures))
print("from the path")
for name, each in beyond.items():
    print(f"{name:<16}" + "".join(f"{value:9.4f}" for run in each.runs for value in run.rms_path))
# There at the moment of the sample, and late in between: see docs/explanation/comparison.md.
assert beyond["fuzzy-smooth"].beats_all
assert min(beyond["fuzzy-smooth"].runs[0].rms_path) > max(beyond["pd-motor"].runs[0].rms_path)
assert not beyond["fuzzy-fine"].beats_all
assert all(each.beats_those_without_model for each in beyond.values())

TRAJECTORIES = {
    "reach and return, no payload": (reach_return(), False),
    "far and fast": (through([(60, -30), (20, -80), (75, -10)], segment=1.5, hold=1.0), True),
    "120 degrees in 2 s": (through([(-40, 50), (80, 20), (10, -60)], segment=2.0, hold=1.0), True),
    "way points": (through([(-30, 40), (50, 20), (10, -40)], segment=2.0, hold=1.0), True),
    "small and quick": (pick_and_place(angles=(15.0, -25.0), segment=0.5), True),
    "more than the supply has": (pick_and_place(angles=(80.0, -20.0), segment=1.0), True),
}
for name, (path, payload) in TRAJECTORIES.items():
    print(f"\n{name}: RMS error, degrees, at the set points and from the path")
    for each in (*NAMES, "soc-table", "hfie", "acdid+ie"):
        run = simulate(controller(each), path, payload=payload)
        print(f"  {each:<16}" + "".join(f"{value:9.4f}" for value in (*run.rms, *run.rms_path)))
