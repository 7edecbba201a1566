"""Checks the passes by a second, slow and simple analysis of random programs."""
