"""Missions with a wrong parameter: flown, recorded, ranked, judged."""
