"""Rules against straight lines: controllers without a model of the arm, and where they end.

All of them drive the same motors at the same 20 V, and follow the same set points, which stand for
five control periods; errors are those at the set points, in the last of the five, and those from
the path on which the set points lie. `fuzzy-fine` is 49 rules on the error and its rate; `pd-motor`
a straight line in their place, `pd-motor-tuned` one with tuned gains. `fuzzy-smooth` and
`pid-smooth` average the set points first, then there are seven rules or a straight line, and an
integral.
"""

from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import pick_and_place, reach_return, through

NAMES = ("fuzzy-fine", "fuzzy-smooth", "pd-motor", "pd-motor-tuned", "pid-smooth")
TRAJECTORIES = {
    "reach and return": (reach_return(), True),
    "reach and return, no payload": (reach_return(), False),
    "far and fast": (through([(60, -30), (20, -80), (75, -10)], segment=1.5, hold=1.0), True),
    "120 degrees in 2 s": (through([(-40, 50), (80, 20), (10, -60)], segment=2.0, hold=1.0), True),
    "way points": (through([(-30, 40), (50, 20), (10, -40)], segment=2.0, hold=1.0), True),
    "small and quick": (pick_and_place(angles=(15.0, -25.0), segment=0.5), True),
    "more than the supply has": (pick_and_place(angles=(80.0, -20.0), segment=1.0), True),
}
for name, (path, payload) in TRAJECTORIES.items():
    print(f"\n{name}: RMS error, degrees, at the set points and from the path")
    runs = {}
    for each in (*NAMES, "soc-table", "hfie", "acdid+ie"):
        runs[each] = run = simulate(controller(each), path, payload=payload)
        print(f"  {each:<16}" + "".join(f"{value:9.4f}" for value in (*run.rms, *run.rms_path)))
    if name == "reach and return":
        # There at the moment of the sample, late in between: docs/explanation/comparison.md.
        assert max(runs["fuzzy-smooth"].rms) < min(runs["pd-motor"].rms)
        assert min(runs["fuzzy-smooth"].rms_path) > max(runs["pd-motor"].rms_path)
