"""The scores of SPEC 7 while a mission runs: the same numbers as offline, at every instant."""
