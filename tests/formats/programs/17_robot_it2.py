import numpy as np
from pyit2fls import IT2FS, IT2Mamdani, max_s_norm, product_t_norm, trapezoid_mf, tri_mf

domain = np.linspace(-1, 1, 101)
N = IT2FS(domain, trapezoid_mf, [-1.1, -1, -0.5, 0.1, 1], trapezoid_mf, [-1.1, -1, -0.6, 0, 0.8])
P = IT2FS(domain, trapezoid_mf, [-0.1, 0.5, 1, 1.1, 1], trapezoid_mf, [0, 0.6, 1, 1.1, 0.8])
robot = IT2Mamdani(product_t_norm, max_s_norm, method="Centroid", algorithm="KM")
robot.add_input_variable("e")
robot.add_output_variable("u")
back = IT2FS(domain, tri_mf, [-1, -0.5, 0.2, 1], tri_mf, [-0.9, -0.5, 0.1, 0.9])
forth = IT2FS(domain, tri_mf, [-0.2, 0.5, 1, 1], tri_mf, [-0.1, 0.5, 0.9, 0.9])
robot.add_rule([("e", N)], [("u", forth)])
robot.add_rule([("e", P)], [("u", back)])


def closed_loop(steps):
    x = 0.8
    for _ in range(steps):
        _, reduced = robot.evaluate({"e": x})
        x += 0.2 * sum(reduced["u"]) / 2
    return x


print(closed_loop(5))
