"""The command ``study report``: the study's page from the study's folder."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import click

from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import progress, warn
from pytpc.cli.lines import say
from pytpc_evaluation.commands.study_options import (
    CHOSEN,
    RANK_AGAIN,
    RANK_JOBS,
    STUDY,
    half_option,
)


@click.command("report")
@STUDY
@click.option(
    "--docs",
    type=PATH,
    default=Path("docs/study.md"),
    show_default=True,
    metavar="FILE",
    help="The page; figures and tables are written beside it.",
)
@half_option("both", "Show the results of this half.")
@RANK_AGAIN
@RANK_JOBS
@JSON
def report_command(
    *, out: Path, docs: Path, half: str, again: bool, jobs: int, as_json: bool
) -> None:
    """Write the study's page, with its tables, figures and data beside it.

    First each method ranks the missions that it has not ranked yet, and those that changed since,
    as the method itself may have. The page says what is missing in the folder.
    """
    # matplotlib takes half a second to import, which other commands need not wait for.
    from pytpc_evaluation.study.report.making import (  # noqa: PLC0415
        ReportOptions,
        json_text,
        make_report,
    )

    with ExitStack() as stack:
        made = make_report(
            out,
            docs,
            ReportOptions(CHOSEN[half], rank="again" if again else "missing", jobs=jobs),
            lambda what: stack.enter_context(progress(what)),
        )
    for trouble in made.troubles:
        warn(plain(trouble))
    if as_json:
        click.echo(json_text(made.numbers), nl=False)
    say(f"{many(len(made.files), 'file')} and {made.page}")
