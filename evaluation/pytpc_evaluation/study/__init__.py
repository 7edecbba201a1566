"""The study: missions of three systems, flown, marked, ranked and reported (docs/study.md)."""
