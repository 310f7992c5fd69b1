from numpy import linspace
from pyit2fls import (
    IT2FLS, IT2FS_Gaussian_UncertStd, IT2FS_plot, TR_plot, crisp, min_t_norm, max_s_norm,
)

domain = linspace(0.0, 1.0, 101)
small = IT2FS_Gaussian_UncertStd(domain, [0, 0.15, 0.1, 1.0])
medium = IT2FS_Gaussian_UncertStd(domain, [0.5, 0.15, 0.1, 1.0])
large = IT2FS_Gaussian_UncertStd(domain, [1.0, 0.15, 0.1, 1.0])
IT2FS_plot(small, medium, large, title="sets")
valve = IT2FLS()
valve.add_input_variable("pressure")
valve.add_input_variable("flow")
valve.add_output_variable("opening")
valve.add_rule([("pressure", small), ("flow", small)], [("opening", large)])
valve.add_rule([("pressure", medium), ("flow", medium)], [("opening", medium)])
valve.add_rule([("pressure", large), ("flow", large)], [("opening", small)])
sets, reduced = valve.evaluate(
    {"pressure": 0.4, "flow": 0.6}, min_t_norm, max_s_norm, domain, method="Centroid",
    algorithm="KM",
)
TR_plot(domain, reduced["opening"])
print(crisp(reduced["opening"]))
