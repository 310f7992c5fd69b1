"""The best controller without a model of the arm that we could write, and where it ends.

Its rules are in rulebases/fine7.frb: 49 rules on the error and its rate, as in the study, with
sets that are narrow around zero and outer sets of the output at the very end of the scale. The
wiring, the supply of 20 V and the sampling rates are the study's. Widths of the sets and rules
were chosen on the study's two trajectories and on the second and third below; on the last two
nothing was chosen.
"""

from fuzzyarm.controller import controller
from fuzzyarm.loop import simulate
from fuzzyarm.plant import pick_and_place, reach_return, through
from fuzzyarm.study.reproduce import run_beyond

beyond = run_beyond()
print("RMS errors under the conditions of the study's summary table, degrees")
print("fuzzy-fine            " + "".join(f"{value:9.4f}" for value in beyond.rms))
print("best published without" + "".join(f"{value:9.4f}" for value in beyond.to_beat))
assert beyond.better

TRAJECTORIES = {
    "reach and return, no payload": (reach_return(), False),
    "far and fast": (through([(60, -30), (20, -80), (75, -10)], segment=1.5, hold=1.0), True),
    "the supply runs out": (through([(-40, 50), (80, 20), (10, -60)], segment=2.0, hold=1.0), True),
    "unseen: way points": (through([(-30, 40), (50, 20), (10, -40)], segment=2.0, hold=1.0), True),
    "unseen: small and quick": (pick_and_place(angles=(15.0, -25.0), segment=0.5), True),
}
for name, (path, payload) in TRAJECTORIES.items():
    print(f"\n{name}: RMS error, degrees")
    for each in ("fuzzy-fine", "soc-table", "hfie", "acdid+ie"):
        rms = simulate(controller(each), path, payload=payload).rms
        print(f"  {each:<12}{rms[0]:9.4f}{rms[1]:9.4f}")
