"""Run some controllers along the same trajectory and compare their errors."""

from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import pick_and_place

path = pick_and_place(angles=(60.0, -30.0), segment=1.5)

print(f"{'controller':<12}{'rms 1':>10}{'rms 2':>10}{'max 1':>10}{'max 2':>10}   degrees")
for name in ("pd", "ct", "cdid", "acdid", "pd+cdid"):
    run = simulate(controller(name), path, payload=True)
    figures = (*run.rms, *run.maximum)
    print(f"{name:<12}" + "".join(f"{value:>10.4f}" for value in figures))

# Gains are data: look at them, change them.
stiff = controller("pd").with_gains({"K_P": [1000.0]})
print(f"\npd with K_P {stiff.gains['K_P'].value} {stiff.gains['K_P'].unit}:")
print(simulate(stiff, path, payload=True).rms)
