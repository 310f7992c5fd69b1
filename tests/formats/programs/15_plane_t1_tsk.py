from numpy import linspace, meshgrid, zeros
from pyit2fls import T1FS, T1TSK, gaussian_mf

domain = linspace(-4, 4, 101)
low = T1FS(domain, gaussian_mf, [-2, 1.5, 1.0])
high = T1FS(domain, gaussian_mf, [2, 1.5, 1.0])


def both_high(a, b):
    return a * b + 1


plane = T1TSK()
plane.add_input_variable("x")
plane.add_input_variable("y")
plane.add_output_variable("z")
plane.add_rule([("x", low), ("y", low)], [("z", lambda a, b: a + b + 1)])
plane.add_rule([("x", low), ("y", high)], [("z", lambda a, b: 2 * a - b)])
plane.add_rule([("x", high), ("y", low)], [("z", lambda a, b: -1.5)])
plane.add_rule([("x", high), ("y", high)], [("z", both_high)])
points = linspace(-3, 3, 4)
surface = zeros((4, 4))
for i, x in enumerate(points):
    for j, y in enumerate(points):
        surface[i, j] = plane.evaluate({"x": x, "y": y}, params=(x, y))["z"]
print(surface)
