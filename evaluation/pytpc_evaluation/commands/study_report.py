"""The command ``study report``: the study's page from the study's folder."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import click

from pytpc.base.wording import many, plain
from pytpc.cli.console import progress, warn
from pytpc.cli.options import JSON, PATH
from pytpc_evaluation.commands.study_options import CHOSEN, RANK_AGAIN, RANK_JOBS, STUDY


@click.command("report")
@STUDY
@click.option(
    "--docs",
    type=PATH,
    default=Path("docs/study.md"),
    show_default=True,
    metavar="FILE",
    help="The page; its figures and tables go beside it.",
)
@click.option(
    "--half",
    type=click.Choice(list(CHOSEN)),
    default="both",
    show_default=True,
    help="Whose results are shown.",
)
@RANK_AGAIN
@RANK_JOBS
@JSON
def report_command(
    *, out: Path, docs: Path, half: str, again: bool, jobs: int, as_json: bool
) -> None:
    """Write every table and figure of the study: a page, with figures and CSV beside it.

    First each method ranks the missions that it has not ranked yet, or that, as the method itself,
    are not as they were then. What is missing in the folder is said on the page.
    """
    # matplotlib takes half a second to import, which other commands need not wait for.
    from pytpc_evaluation.study.report.making import json_text, make_report  # noqa: PLC0415

    with ExitStack() as stack:
        made = make_report(
            out,
            docs,
            CHOSEN[half],
            lambda what: stack.enter_context(progress(what)),
            rank="again" if again else "missing",
            jobs=jobs,
        )
    for trouble in made.troubles:
        warn(plain(trouble))
    if as_json:
        click.echo(json_text(made.numbers), nl=False)
    click.echo(f"{many(len(made.files), 'file')} and {made.page}", err=True)
