"""Scores, ranks and rankings of SPEC 7: offline, over a grid of times, and live."""
