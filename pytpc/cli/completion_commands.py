"""Commands for the shell: ``completion``."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path

import click
from click.shell_completion import CompletionItem, get_completion_class, split_arg_string

from pytpc.base.paths import MERGED_FILE, OWN_FOLDER

_VARIABLE = "_PYTPC_COMPLETE"
_SHELLS = ("bash", "zsh", "fish")
_LARGEST = 64 << 20


@click.command("completion")
@click.argument("shell", type=click.Choice(_SHELLS))
def completion_command(shell: str) -> None:
    """Print a script that makes SHELL complete pytpc's commands, options, files and parameters.

    \b
    bash:  eval "$(pytpc completion bash)"   in ~/.bashrc
    zsh:   eval "$(pytpc completion zsh)"    in ~/.zshrc, after compinit
    fish:  pytpc completion fish > ~/.config/fish/completions/pytpc.fish
    """
    found = get_completion_class(shell)
    assert found is not None, "click has these three"
    root = click.get_current_context().find_root().command
    script = found(root, {}, "pytpc", _VARIABLE).source()
    click.echo(f"# `pytpc completion --help` says where this goes.\n{script}")


def offer_parameters(
    ctx: click.Context, _: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """The robot's parameters that begin like what was typed, with or without their ``~``.

    They are looked for where the command's own option ``--static`` says, else among its other
    arguments, else here. Files are offered where there is none: completion never complains.
    """
    names = [
        CompletionItem(name)
        for name in parameter_names(_sources(ctx))
        if name.startswith(incomplete) or name.lstrip("~/").startswith(incomplete)
    ]
    # The shells' scripts take either words or files.
    return names or [CompletionItem(incomplete, type="file")]


def parameter_names(sources: Iterable[Path]) -> list[str]:
    """The sorted names in the first source that has any; read without checks, to be fast."""
    for source in sources:
        for path in (source, source / OWN_FOLDER / MERGED_FILE, source / MERGED_FILE):
            names = _names_in(path)
            if names:
                return names
    return []


def _sources(ctx: click.Context) -> list[Path]:
    """Where the static information may be, the likeliest place first."""
    static = ctx.params.get("static_source")
    found = [Path(static)] if static else []
    for value in ctx.params.values():
        values = value if isinstance(value, tuple) else (value,)
        found += [Path(one) for one in values if isinstance(one, str | os.PathLike)]
    # While the value of an option is typed, click has not read the arguments behind it.
    found += [Path(word) for word in split_arg_string(os.environ.get("COMP_WORDS", ""))[2:]]
    return [*found, Path()]


def _names_in(path: Path) -> list[str]:
    try:
        if not path.is_file() or path.stat().st_size > _LARGEST:
            return []
        document = json.loads(path.read_bytes())
        units = document.get("units", [document])
        names = {found["source"] for unit in units for found in unit["comparisons"]}
        return sorted(name for name in names if isinstance(name, str))
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return []


COMMANDS: list[click.Command] = [completion_command]
