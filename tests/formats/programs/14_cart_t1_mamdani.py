from numpy import linspace
from pyit2fls import T1FS, T1FS_plot, T1Mamdani, gaussian_mf, trapezoid_mf, tri_mf

domain = linspace(-1, 1, 201)
negative = T1FS(domain, trapezoid_mf, [-1.01, -1, -0.6, 0.0, 1.0])
zero = T1FS(domain, gaussian_mf, [0, 0.3, 1.0])
positive = T1FS(domain, trapezoid_mf, [0.0, 0.6, 1, 1.01, 1.0])
T1FS_plot(negative, zero, positive, legends=["N", "Z", "P"])
left = T1FS(domain, tri_mf, [-1, -0.5, 0.1, 1.0])
still = T1FS(domain, gaussian_mf, [0, 0.2, 1.0])
right = T1FS(domain, tri_mf, [-0.1, 0.5, 1, 1.0])

cart = T1Mamdani(engine="Minimum")
cart.add_input_variable("position")
cart.add_input_variable("speed")
cart.add_output_variable("force")
cart.add_rule([("position", negative), ("speed", zero)], [("force", right)])
cart.add_rule([("position", zero), ("speed", zero)], [("force", still)])
cart.add_rule([("position", positive), ("speed", zero)], [("force", left)])
for at in linspace(-0.9, 0.9, 5):
    sets, values = cart.evaluate({"position": at, "speed": 0.1})
    print(values["force"])
