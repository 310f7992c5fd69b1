"""Controllers that learn: training along a trajectory."""
