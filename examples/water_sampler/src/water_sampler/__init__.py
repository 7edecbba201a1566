"""The mission of the water sampler: what the UAV does, from take-off to landing."""
