from tkinter import *
from tkinter import messagebox

import numpy as np
import skfuzzy as fuzz
from skfuzzy import control as ctrl

dirt = ctrl.Antecedent(np.linspace(0, 100, 101), "dirt")
load = ctrl.Antecedent(np.linspace(0, 10, 101), "load")
minutes = ctrl.Consequent(np.linspace(0, 120, 121), "minutes")
for variable in (dirt, load):
    variable.automf(names=["low", "medium", "high"])
minutes["short"] = fuzz.gaussmf(minutes.universe, 20, 12)
minutes["normal"] = fuzz.gaussmf(minutes.universe, 60, 12)
minutes["long"] = fuzz.gaussmf(minutes.universe, 100, 12)
washing = ctrl.ControlSystem([
    ctrl.Rule(dirt["low"] & load["low"], minutes["short"]),
    ctrl.Rule(dirt["medium"] | load["medium"], minutes["normal"]),
    ctrl.Rule(dirt["high"] & ~load["low"], minutes["long"]),
])


class App(Frame):
    def __init__(self, root):
        super().__init__(root)
        self.sim = ctrl.ControlSystemSimulation(washing)
        self.dirt = Scale(self, from_=0, to=100, orient=HORIZONTAL)
        self.dirt.pack(side=TOP, fill=X)
        Button(self, text="Wash", command=self.wash).pack()

    def wash(self):
        self.sim.input["dirt"] = self.dirt.get()
        self.sim.compute()
        messagebox.showinfo("minutes", f"{self.sim.output['minutes']:.1f}")


root = Tk()
root.title("washer")
App(root).pack()
root.mainloop()
