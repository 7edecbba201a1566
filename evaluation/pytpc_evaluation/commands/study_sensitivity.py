"""The command ``study sensitivity``: the study's missions, looked at by other people."""

from __future__ import annotations

from pathlib import Path

import click

from pytpc.cli.console import progress
from pytpc.cli.lines import say
from pytpc_evaluation.commands.study_options import (
    CHOSEN,
    RANK_AGAIN,
    RANK_JOBS,
    STUDY,
    half_option,
)


@click.command("sensitivity")
@STUDY
@half_option("tuning", "Rank the missions of this half.")
@RANK_AGAIN
@RANK_JOBS
def sensitivity_command(*, out: Path, half: str, again: bool, jobs: int) -> None:
    """Rank the missions by the marks of other people than the study's own.

    They are faster or slower, vary more, mark both kinds of errors equally often, work alone, or
    toss a coin for the type. Nothing is flown; ``study report`` shows the result.
    """
    from pytpc_evaluation.study.report.sensitivity import SENSITIVITY_FILE, by_others  # noqa: PLC0415

    with progress("ranking by other people's marks") as advance:
        by_others().complete(out, CHOSEN[half], advance, again=again, jobs=jobs)
    say(f"{out / SENSITIVITY_FILE}")
