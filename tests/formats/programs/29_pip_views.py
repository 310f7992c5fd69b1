pip install scikit-fuzzy
import msvcrt

import numpy as np
import seaborn as sns
import skfuzzy as fuzz
from skfuzzy import control as ctrl

light = ctrl.Antecedent(np.arange(0, 11, 1), "light")
blind = ctrl.Consequent(np.arange(0, 101, 5), "blind")
blind.accumulation_method = np.add
light.automf(3)
blind["open"] = fuzz.trimf(blind.universe, [0, 0, 60])
blind["shut"] = fuzz.trimf(blind.universe, [40, 100, 100])
rules = [
    ctrl.Rule(light["poor"], blind["open"]),
    ctrl.Rule(light["average"], blind["open"]),
    ctrl.Rule(light["good"], blind["shut"]),
]
rules[0].view()
shading = ctrl.ControlSystem(rules)
shading.view()
sns.heatmap(np.eye(3), annot=True)
msvcrt.getch()
