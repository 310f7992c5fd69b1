import os

import matplotlib.pyplot as plt
import numpy as np
import skfuzzy as fuzz
from matplotlib import cm
from mpl_toolkits.mplot3d import Axes3D
from skfuzzy import control as ctrl

x = np.linspace(-2, 2, 5)
error = ctrl.Antecedent(x, "error")
delta = ctrl.Antecedent(x, "delta")
output = ctrl.Consequent(x, "output")
names = ["nb", "ns", "ze", "ps", "pb"]
for each in (error, delta, output):
    each.automf(names=names)
rules = [
    ctrl.Rule(error[a] & delta[b], output[names[min(4, max(0, i + j - 2))]])
    for i, a in enumerate(names)
    for j, b in enumerate(names)
]
control_surface = ctrl.ControlSystem(rules)
simulation = ctrl.ControlSystemSimulation(control_surface, flush_after_run=441)
at = np.linspace(-2, 2, 6)
across, along = np.meshgrid(at, at)
z = np.zeros_like(across)
for i in range(6):
    for j in range(6):
        simulation.input["error"] = across[i, j]
        simulation.input["delta"] = along[i, j]
        simulation.compute()
        z[i, j] = simulation.output["output"]
figure = plt.figure(figsize=(8, 8))
ax = figure.add_subplot(111, projection="3d")
ax.plot_surface(across, along, z, cmap="viridis", linewidth=0.4)
plt.savefig("/home/somebody/Desktop/figures/surface.png", dpi=300)
figure.savefig(os.path.join("figures", "surface.pdf"))
