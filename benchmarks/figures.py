"""The one line that each figure is printed as."""

from __future__ import annotations


def figure(  # noqa: PLR0913 - the fields of the line
    topic: str, name: str, value: float, *, unit: str, target: str, hit: bool
) -> None:
    """Prints ``FIGURE <topic> <name> value= unit= target= verdict=``; a miss is said to be one."""
    verdict = "hit" if hit else "miss"
    line = f"FIGURE {topic} {name} value={value:.4g} unit={unit} target={target} verdict={verdict}"
    print(line, flush=True)
