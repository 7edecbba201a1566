"""A package in Python alone."""
