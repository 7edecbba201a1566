"""Options that several commands of the study have."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from pytpc.cli.arguments import PATH
from pytpc_evaluation.study.plan import HALVES, SEEDS, Half

Command = TypeVar("Command", bound=Callable[..., Any])

CHOSEN: dict[str, tuple[Half, ...]] = {"tuning": ("tuning",), "held-back": ("held-back",)}
CHOSEN["both"] = HALVES
"""The halves that ``--half`` stands for."""

STUDY = click.option(
    "--out",
    type=PATH,
    default=Path("out/study"),
    show_default=True,
    metavar="DIR",
    help="The study's folder.",
)


def half_option(default: str, text: str) -> Callable[[Command], Command]:
    """The option ``--half``: one of ``CHOSEN``."""
    return click.option(
        "--half",
        type=click.Choice(list(CHOSEN)),
        default=default,
        show_default=True,
        help=text,
    )


def seed_option(text: str) -> Callable[[Command], Command]:
    """The option ``--seed``; the command gets ``seeds`` as texts."""
    return click.option(
        "--seed",
        "seeds",
        type=click.Choice([str(seed) for seed in SEEDS]),
        multiple=True,
        help=f"{text} with this seed; may be repeated.",
    )


RANK_AGAIN = click.option("--again", is_flag=True, help="Rank everything again.")
RANK_JOBS = click.option(
    "--jobs",
    type=click.IntRange(1, 64),
    default=os.cpu_count() or 1,
    show_default="cores of this machine",
    help="How many processes rank at once.",
)
