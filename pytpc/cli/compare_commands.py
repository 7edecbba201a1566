"""The command ``compare``: what differs between two builds, or what two recordings decided."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun, is_recording
from pytpc.api.comparing_builds import compare_builds, sarif_of_changes
from pytpc.api.comparing_decisions import compare_decisions
from pytpc.api.missions import same_reports
from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json
from pytpc.base.errors import InputError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, tell_next, telling, warn
from pytpc.cli.lines import say
from pytpc.cli.options import STATIC, check, recording_of
from pytpc.cli.sources import static_for, static_of
from pytpc.present.build_comparison import build_changes_json, print_build_changes
from pytpc.present.comparison_markdown import markdown
from pytpc.present.decision_tables import decisions_json, print_decisions
from pytpc.present.junit import junit
from pytpc.static.budget import RULES, Rule, Verdict, verdicts


@dataclass(frozen=True)
class _CompareArguments:
    old: Path
    new: Path
    everything: bool
    constants: bool
    sarif: Path | None
    junit: Path | None
    markdown: str | None
    srcroot: Path | None
    fail_on: tuple[Rule, ...]
    budget: int | None
    static_source: Path | None
    as_json: bool

    @property
    def of_builds(self) -> list[str]:
        """The options that were given and make sense for builds only."""
        given = {
            "--constants": self.constants,
            "--sarif": self.sarif,
            "--junit": self.junit,
            "--markdown": self.markdown,
            "--srcroot": self.srcroot,
            "--fail-on": self.fail_on,
            "--budget": self.budget is not None,
        }
        return [name for name, value in given.items() if value]


@click.command("compare")
@click.argument("old", type=PATH)
@click.argument("new", type=PATH)
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Builds: list moved comparisons, other distances and all blind spots, too. Recordings:"
    " list comparisons that decided alike, too.",
)
@click.option("--constants", is_flag=True, help="Compare comparisons with constants, too.")
@click.option("--sarif", type=PATH, metavar="FILE", help="Write SARIF 2.1.0 with baseline states.")
@click.option("--junit", type=PATH, metavar="FILE", help="Write the rules as JUnit XML.")
@click.option(
    "--markdown", metavar="FILE|-", help="Write Markdown for a pull request; - prints only that."
)
@click.option(
    "--srcroot",
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="Folder that SARIF's paths are relative to. [default: what all packages share]",
)
@click.option(
    "--fail-on",
    "fail_on",
    type=click.Choice(list(RULES)),
    multiple=True,
    help="Exit with status 1 if this is found; may be repeated.",
)
@click.option(
    "--budget",
    type=click.IntRange(min=0),
    metavar="N",
    help="Exit with status 1 if more than N comparisons are new.",
)
@STATIC
@JSON
@as_object(_CompareArguments)
def compare_command(given: _CompareArguments) -> None:
    """Show what differs between two builds, or what two recordings decided.

    OLD and NEW are builds, as for `list` (a static.json, a build base or a workspace): the
    comparisons that are new, gone or changed, and what became of the parameters. Or both are
    recordings: how often each comparison was evaluated, how it turned out, and by how much.
    `pytpc diff` shows which parameters differ between recordings, and what that changed.

    \b
    Rules of --fail-on:
      new           a comparison is new
      gone          a comparison is gone, although its link unit was built
      changed       a comparison changed: its operator, parameter, default, ...
      undeclared    a parameter is compared anew, and nothing declares it
      lost          a parameter that is still read is not compared any more
      missing-unit  a link unit of OLD is missing in NEW, or was not analysed
    """
    old, new = map(is_recording, (given.old, given.new))
    if old != new:
        recording, build = (given.old, given.new) if old else (given.new, given.old)
        raise InputError(
            f"is a recording, and {plain(str(build))} is a build; give two builds or two"
            " recordings. What the recording ran is the static information beside it",
            recording,
        )
    if old:
        _refuse(given.of_builds, "recordings")
        _compare_recordings(given)
        return
    _refuse(["--static"] if given.static_source is not None else [], "builds")
    if given.as_json and given.markdown == "-":
        raise click.UsageError("--json and --markdown - both print; give --markdown FILE")
    _compare_builds(given)


def _refuse(options: Sequence[str], what: str) -> None:
    if options:
        raise click.UsageError(f"{options[0]} does not go with two {what}")


def _compare_builds(given: _CompareArguments) -> None:
    old, new = static_of([given.old]), static_of([given.new])
    with telling("comparing the builds"):
        found = compare_builds(old, new, constants=given.constants, on_skipped=warn)
    judged = verdicts(found, given.fail_on, given.budget)
    if given.sarif is not None:
        with telling("writing SARIF"):
            log = sarif_of_changes(old, new, found, given.srcroot)
            write_atomic(given.sarif, dump_json(log))
    if given.junit is not None:
        write_atomic(given.junit, junit(judged))
    if given.markdown is not None and given.markdown != "-":
        write_atomic(Path(given.markdown), markdown(found, judged).encode())
    if given.as_json:
        print_json(build_changes_json(found, judged))
    elif given.markdown == "-":
        click.echo(markdown(found, judged), nl=False)
    else:
        print_build_changes(console(), found, everything=given.everything)
    _end(judged)


def _compare_recordings(given: _CompareArguments) -> None:
    recordings = [recording_of(source) for source in (given.old, given.new)]
    old, new = (
        RecordedRun(recording, source)
        for recording, source in zip(recordings, (given.old, given.new), strict=True)
    )
    static = static_for(given.static_source, given.new, recordings[1])
    check(old.in_build(static).recording, static, given.old)
    check(new.recording, static, given.new)
    if same_reports(*recordings):
        raise InputError(f"has the same reports as {plain(str(given.old))}", given.new)
    with telling("comparing the recordings"):
        found = compare_decisions(old, new, static)
    for name, count in zip(("OLD", "NEW"), found.unknown, strict=True):
        if count:
            warn(f"{name}: {many(count, 'comparison')} that the static information does not have")
    if given.as_json:
        print_json(decisions_json(found))
        return
    print_decisions(console(), found, everything=given.everything)
    words = ["pytpc", "diff", str(given.old), str(given.new)]
    tell_next(f"{shlex.join(words)}   # which parameters differ, and what that changed")


def _end(judged: Sequence[Verdict]) -> None:
    """Say which rules are broken, one line each, and end with status 1 if any is."""
    broken = [one for one in judged if one.is_broken]
    for one in broken:
        say(plain(f"pytpc: error: {one.line}"))
    if broken:
        click.get_current_context().exit(1)


COMMANDS: list[click.Command] = [compare_command]
