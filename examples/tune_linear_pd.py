"""Tune the linear PD of the motors on random moves, and look whether it overfits.

The four gains move on 24 random moves until the mean of the RMS errors (geometric, both joints) no
longer falls; 48 other moves say whether it learned the moves or the arm. `pd-motor-tuned` has what
comes out, rounded. `python tune_linear_pd.py 20` stops after 20 evaluations.
"""

import sys

import numpy as np
from scipy.optimize import minimize

from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import through

LOST = 1000.0  # degrees, for a run that diverged


def random_moves(seed, count):
    """Two to four way points within ± 90°, 0.8 to 3 s for each move, mostly with load."""
    rng = np.random.default_rng(seed)
    moves = []
    for _ in range(count):
        points = np.round(rng.uniform(-90, 90, (int(rng.integers(2, 5)), 2)))
        path = through([tuple(each) for each in points], float(rng.uniform(0.8, 3.0)), hold=1.0)
        moves.append((path, bool(rng.random() < 0.7)))
    return moves


def runs_on(moves, name, gains=()):
    """Return the run of a controller on each move."""
    law = controller(name).with_gains(dict(gains))
    return [simulate(law, path, payload=payload) for path, payload in moves]


def errors(runs, sense="rms"):
    """Return the RMS error of each joint on each move, degrees, in one of its senses."""
    return np.array([getattr(run, sense) if run.diverged is None else (LOST,) * 2 for run in runs])


def score(logs):
    """Return what is to fall: the mean of the logarithms of all errors on the training moves."""
    gains = {"K_p": np.exp(logs[:2]), "K_d": np.exp(logs[2:])}
    return float(np.log(errors(runs_on(TRAINING, "pd-motor-tuned", gains))).mean())


TRAINING, UNSEEN = random_moves(1, 24), random_moves(2, 48)
evaluations = int(sys.argv[1]) if len(sys.argv) > 1 else 200
start = np.log([100.0, 100.0, 16.0, 16.0])
found = minimize(score, start, method="Nelder-Mead", options={"maxfev": evaluations, "xatol": 0.01})
k_p, k_d = np.exp(found.x[:2]), np.exp(found.x[2:])
print(f"after {found.nfev} evaluations: K_p {k_p.round(1)}, K_d {k_d.round(1)}")

chosen = {"found": ("pd-motor-tuned", {"K_p": k_p, "K_d": k_d}), "pd-motor": ("pd-motor", {})}
chosen |= {name: (name, {}) for name in ("pd-motor-tuned", "fuzzy-fine", "fuzzy-smooth")}
print("geometric mean of the RMS errors, degrees: at the set points, and from the path")
print(f"{'':<24}" + f"{'training':>10}{'unseen':>10}" * 2)
for label, (name, gains) in chosen.items():
    both = [runs_on(moves, name, gains) for moves in (TRAINING, UNSEEN)]
    means = [
        np.exp(np.log(errors(runs, sense)).mean()) for sense in ("rms", "rms_path") for runs in both
    ]
    print(f"{label:<24}" + "".join(f"{mean:10.4f}" for mean in means))
