"""The one door: what the command line, notebooks and pages call."""
