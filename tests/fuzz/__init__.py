"""Fuzzing of the passes: modules that nobody wrote, and programs run with and without them."""
