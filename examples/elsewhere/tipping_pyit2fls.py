"""A tip of interval type 2, in pyit2fls: how far "poor" reaches is not agreed on."""

from numpy import linspace
from pyit2fls import (
    IT2FS,
    IT2FS_Gaussian_UncertStd,
    IT2Mamdani,
    max_s_norm,
    min_t_norm,
    trapezoid_mf,
    tri_mf,
)

quality, percent = linspace(0, 10, 101), linspace(0, 30, 301)
poor = IT2FS_Gaussian_UncertStd(quality, [0, 1.5, 0.4, 1])
good = IT2FS_Gaussian_UncertStd(quality, [5, 1.5, 0.4, 1])
excellent = IT2FS_Gaussian_UncertStd(quality, [10, 1.5, 0.4, 1])
rancid = IT2FS(quality, trapezoid_mf, [-1, 0, 1, 4, 1], trapezoid_mf, [-1, 0, 1, 3, 0.8])
delicious = IT2FS(quality, trapezoid_mf, [6, 9, 10, 11, 1], trapezoid_mf, [7, 9, 10, 11, 0.8])
cheap = IT2FS(percent, tri_mf, [0, 5, 10, 1], tri_mf, [1, 5, 9, 0.9])
average = IT2FS(percent, tri_mf, [10, 15, 20, 1], tri_mf, [11, 15, 19, 0.9])
generous = IT2FS(percent, tri_mf, [20, 25, 30, 1], tri_mf, [21, 25, 29, 0.9])

tipping = IT2Mamdani(min_t_norm, max_s_norm, method="Centroid", algorithm="KM")
tipping.add_input_variable("service")
tipping.add_input_variable("food")
tipping.add_output_variable("tip")
tipping.add_rule([("service", poor), ("food", rancid)], [("tip", cheap)])
tipping.add_rule([("service", good)], [("tip", average)])
tipping.add_rule([("service", excellent), ("food", delicious)], [("tip", generous)])

if __name__ == "__main__":
    _, reduced = tipping.evaluate({"service": 7, "food": 8})
    print("tip", sum(reduced["tip"]) / 2)
