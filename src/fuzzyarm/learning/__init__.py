"""Rule bases from samples, and judged by samples; controllers that learn along a trajectory."""
