"""The one line that each figure is printed as, and what a command takes."""

from __future__ import annotations

import os
import subprocess


def figure(  # noqa: PLR0913 - the fields of the line
    topic: str, name: str, value: float, *, unit: str, target: str, hit: bool
) -> None:
    """Prints ``FIGURE <topic> <name> value= unit= target= verdict=``; a miss is said to be one."""
    verdict = "hit" if hit else "miss"
    line = f"FIGURE {topic} {name} value={value:.4g} unit={unit} target={target} verdict={verdict}"
    print(line, flush=True)


def measured(*command: str) -> tuple[float, float]:
    """Processor seconds (user and system) and peak MB of a command."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command)}: exit status {status}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
