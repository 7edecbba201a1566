"""The thesis's numbers that the page compares with, as printed there, by table.

Tables 6.12 to 6.16 are of its image capture missions alone; ``RANGES`` are over its three systems
(chapters 6.3 to 6.6; docs/reference/thesis-figures.md).
"""

from __future__ import annotations

from collections.abc import Mapping

RUNTIME_SUMMARY: Mapping[str, tuple[float, ...]] = {
    "mean": (1.89, 15111.53, 24.04, 72.89, 46.16, 58.49, 41.51),
    "median": (1, 17439, 27.74, 95, 0, 66.44, 33.56),
    "std": (1.76, 15106.26, 24.03, 34.87, 153.36, 43, 43),
    "minimum": (1, 5, 0.01, 0, 0, 0, 0),
    "maximum": (8, 64884, 103.22, 99, 673, 100, 100),
    "sum": (36, 287119, 456.78, 1385, 877, 1111.27, 788.73),
}
"""The last rows of table 6.12, column by column."""


CONFUSION: Mapping[str, tuple[int, int]] = {"type1": (2, 15), "type2": (26, 25)}
"""Table 6.13: marks of type I and of type II on the treatments of a type."""

DELAYS: Mapping[str, tuple[tuple[float, ...], ...]] = {
    "type1": ((11.69, 25.07, 11.45, 21.63), (3.12, 3.78, 0.96)),
    "type2": ((6.99, 12.37, 12.07), (1.71, 9.97, 9.91)),
}
"""Table 6.14: seconds to the first mark of each user who set one, by trial."""

MARKS: Mapping[str, tuple[tuple[int, int], ...]] = {
    "type1": ((0, 8), (2, 7)),
    "type2": ((19, 3), (7, 22)),
    "fault": ((6, 19), (0, 17)),
    "clean": ((0, 0), (5, 2)),
}
"""The totals of table 6.15: marks of type I and type II of all four users, by trial."""

USERS = 4

FOUND: Mapping[str, tuple[tuple[float | None, float | None], ...]] = {
    "type1": ((None, 0.80), (0.98, 0.88)),
    "type2": ((0.20, 0.96), (0.00, 0.15)),
}
"""Table 6.16: mean rank at marks of type I and of type II, by trial.

None where the thesis prints 0.00 with a score of 9999.00: there were no marks. So rightly typed it
has 0.98, 0.96 and 0.15, wrongly typed 0.80, 0.88, 0.20 and 0.00.
"""

RANGES: Mapping[str, str] = {
    "comparisons per second": "126 to 456",
    "flops, % of the comparisons": "0.03 to 0.4",
    "places in the source never evaluated, %": "40 to 60",
}
"""What its text says of its three systems."""

IMAGE_CAPTURE: Mapping[str, float] = {
    "comparisons per second": 456.78,
    "flops, % of the comparisons": 0.31,
    "places in the source never evaluated, %": 41.0,
    "places in the source": 61,
}
"""The same of its image capture system (6.5.2, 6.5.3)."""
