"""The command ``study suggestions``: what to fly next, and the results so far."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON
from pytpc.cli.console import console, print_json, progress, warn
from pytpc_evaluation.commands.study_options import CHOSEN, STUDY, half_option, seed_option
from pytpc_evaluation.study.methods import METHODS
from pytpc_evaluation.study.plan import SEEDS
from pytpc_evaluation.study.resume import alone_with_results
from pytpc_evaluation.study.suggested import WANTED_FILE
from pytpc_evaluation.study.suggestion_chains import VARIANTS, Chain, shares
from pytpc_evaluation.study.suggestions import Asked, next_round


@click.command("suggestions")
@STUDY
@half_option("both", "Ask about the missions of this half.")
@click.option(
    "--variant",
    "variants",
    type=click.Choice(list(VARIANTS)),
    multiple=True,
    help="Ask for only this variant; may be repeated.",
)
@seed_option("Ask only about missions")
@click.option(
    "--method",
    type=click.Choice(list(METHODS)),
    help="Also try the first suspects of this ranking.",
)
@click.option(
    "--again",
    is_flag=True,
    help="Start over, after the ranking or the advice changed; flights are kept.",
)
@JSON
def suggestions_command(
    *,
    out: Path,
    half: str,
    variants: tuple[str, ...],
    seeds: tuple[str, ...],
    method: str | None,
    again: bool,
    as_json: bool,
) -> None:
    """Read the results of flown suggestions, and list what to fly next.

    Alternate it with ``study suggested`` until nothing is left.
    """
    ranking = None if method is None else METHODS[method]
    with alone_with_results(out), progress("working out suggestions") as advance:
        numbers = [int(seed) for seed in seeds] or SEEDS
        asked = Asked(CHOSEN[half], ranking, variants or tuple(VARIANTS), numbers, again)
        chains = next_round(out, asked, advance)
    mine = [chain for chain in chains if chain.half in CHOSEN[half]]
    for chain in mine:
        for one in chain.tries:
            if one.failed:
                warn(plain(f"{chain.mission}, {chain.variant}: {one.reason}"))
    if as_json:
        document = [asdict(share) for share in shares(mine)]
        print_json(document)
        return
    _show(mine)
    left = {chain.mission for chain in mine if not chain.is_over}
    what = f"{many(len(left), 'mission')} to fly: {out / WANTED_FILE}"
    click.echo(plain(what if left else "nothing is left to fly"))


def _show(chains: list[Chain]) -> None:
    table = Table()
    for heading in ("Variant", "Tries", "Treatments", "Gone %", "New error %", "Waiting"):
        table.add_column(heading, justify="left" if heading == "Variant" else "right")
    for share in shares(chains):
        rates = ["-" if r is None else f"{100 * r:.0f}" for r in (share.gone, share.new_error)]
        numbers = (str(share.tries), str(share.treatments), *rates, str(share.open))
        table.add_row(Text(share.variant), *numbers)
    console().print(table, highlight=False)
