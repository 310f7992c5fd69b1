"""Train self-organizing control from nothing, look at what it learned, put the table to work.

With the study's learning rate of 1 the table keeps jumping: it steers well while it learns
and badly once it is frozen. A hundredth of that settles, and what is left is a table.
"""

import tempfile
from pathlib import Path

from fuzzyarm import shipped
from fuzzyarm.control.controllers import Sources, controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.learning import train
from fuzzyarm.plant import pick_and_place, reach_return
from fuzzyarm.table import read_table, write_table

judge = read_table(shipped("performance-yamazaki.lut"))  # the control table has its levels
learner = controller("soc-zero").with_gains({"learning_rate": [0.01]})

last = None
for last in train(learner, pick_and_place(), passes=5, payload=True):
    used = (last.learned.visits > 0).sum(axis=(1, 2))
    print(
        f"pass {last.passage}: RMS error {last.rms[0]:.4f}° and {last.rms[1]:.4f}°, "
        f"{used[0]} and {used[1]} of 169 cells used so far"
    )
assert last is not None

learned = last.learned.table(judge)
with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "learned.lut"  # an ordinary table: show it, diff it, compile it to C
    write_table(learned, file)
    deployed = controller("fuzzy-lut-x10", sources=Sources(table=read_table(file)))

by_hand = controller("fuzzy-lut-x10")
for path in (pick_and_place(), reach_return()):
    for name, made in (("by hand", by_hand), ("learned", deployed)):
        rms = simulate(made, path, payload=True).rms
        print(f"{path.name:<15} table {name}: RMS error {rms[0]:.4f}° and {rms[1]:.4f}°")
