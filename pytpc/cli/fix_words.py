"""What ``pytpc fix`` prints: where a conversation stands, what it proposes, and what is next."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import click

from pytpc.api.fix_files import Setting, run_again
from pytpc.api.fix_state import STATE_FILE, FixState, FixTry
from pytpc.api.fixing import Conversation, Proposal
from pytpc.base.wording import exact, listed, percent, plain, show
from pytpc.cli.console import console, table_of, warn
from pytpc.cli.value_commands import show_diff
from pytpc.diagnosis.results.suspects import SURE, WORTH
from pytpc.diagnosis.trying import KNOWN_GOOD, VERDICTS
from pytpc.values.apply import change_as_json
from pytpc.values.origins import to_json

_TRIES = ("Try", "Parameter", "Change", "Where", "Result", "Probability", "What it says")
_SAID = {
    None: "open",
    "better": "better: the change stays",
    "same": "same: taken back",
    "worse": "worse: taken back",
    "other": "another error: taken back",
    "fixed": "fixed",
}
_SAYS = {
    "better": "it acts on the error; further in this direction",
    "same": "less likely, or not far enough",
    "worse": "not in this direction",
    "other": "it acts on the error; a value between the two",
    "fixed": "it was this parameter",
}
_NAMED = 8
_EXCLUDED = "excluded: this value is known to be good"


def fix_words(file: Path, *words: str) -> str:
    """The command line of ``pytpc fix`` with this state file."""
    given = () if file == STATE_FILE else ("-o", str(file))
    return shlex.join(["pytpc", "fix", *words, *given])


def show_stand(talk: Conversation, file: Path) -> None:
    """Print where a conversation stands: the tries, and its end if it has one."""
    state = talk.judged
    tries = f"{len(state.counted)} of {state.most} tries"
    title = {"open": "open", "fixed": "fixed", "exhausted": f"not fixed: {state.why}"}[state.stand]
    click.echo(plain(f"{state.mission.name}: {title}; {tries}"))
    if not state.tries:
        click.echo(plain(f"  {talk.first.diagnosis.headline}"))
    else:
        console().print(table_of(_TRIES, _rows(talk), right=("Try",)), highlight=False)
    if state.stand == "exhausted":
        _show_suspects(talk)
        if talk.odds.none >= SURE and len(state.counted) < state.most:
            click.echo(plain(f"to go on all the same: {fix_words(file, '--go-on')}"))
    show_standing(state, file)


def _rows(talk: Conversation) -> list[Sequence[str]]:
    now = talk.odds.suspects
    rows: list[Sequence[str]] = []
    for number, one in enumerate(talk.state.tries, start=1):
        probability = percent(one.probability)
        if one.counts and one.verdict != "fixed":
            probability += f" -> {percent(now.get(one.parameter, 0.0))}"
        said = _SAID[one.verdict]
        if one.undone and one.verdict in {None, "better", "fixed"}:
            said = "taken back"
        says = _SAYS.get(one.verdict or "", "")
        if one.verdict == "same" and one.basis in KNOWN_GOOD:
            says = _EXCLUDED
        where = "by hand" if one.path is None else str(one.path)
        change = f"{show(one.old)} -> {exact(one.new)}"
        rows.append((str(number), one.name, change, where, said, probability, says))
    return rows


def _show_suspects(talk: Conversation) -> None:
    click.echo("what is left:")
    left = [(name, part) for name, part in talk.odds.ordered if part >= WORTH]
    rows = [(percent(part), name) for name, part in left]
    rows.append((percent(talk.odds.none), "none of the parameters"))
    console().print(
        table_of(("Probability", "Parameter"), rows, right=("Probability",)), highlight=False
    )

    silent = [one.change for one in talk.first.diagnosis.unreported]
    if silent:
        click.echo(plain(f"not tried, as no comparison reports it: {listed(silent, _NAMED)}"))


def show_standing(state: FixState, file: Path) -> None:
    """Print what is changed now, and how to take it back."""
    for one in state.standing:
        where = "by hand" if one.path is None else str(one.path)
        click.echo(plain(f"changed: {where}: {one.name} {show(one.old)} -> {exact(one.new)}"))
    if state.standing:
        click.echo(plain(f"to take back all: {fix_words(file, '--undo')}"))


def show_next(state: FixState, file: Path) -> None:
    """Say what to do about the open try."""
    found = state.open_try
    if found is None:
        return
    command = run_again(state.mission)
    how = f": {command}" if command else ", as before"
    click.echo(plain(f"next: run the mission again{how}, and mark what goes wrong; then"))
    words = f"{fix_words(file)} --say {'|'.join(VERDICTS)} [--mission RECORDING]"
    click.echo(plain(f"      {words}"))


def show_proposal(proposal: Proposal, how: Setting) -> None:
    """Print what is proposed, why, and the diff of the file."""
    found = proposal.would_be
    click.echo(plain(f"try: {how.name} {show(found.old)} -> {exact(found.new)}"))
    click.echo(plain(f"  {percent(found.probability)} that it is {found.parameter}"))
    node = f" in {found.node}" if found.node else ""
    place = f"compared{node} at {proposal.place}" if proposal.is_compared else proposal.place
    for line in (found.text, place, proposal.effect):
        if line:
            click.echo(plain(f"  {line}"))
    if how.change is None:
        click.echo(plain(f"  {how.by_hand}"))
        return
    show_diff(how.change)
    for note in how.change.notes:
        warn(plain(note))
    if how.change.also:
        warn(plain(f"the same line sets {', '.join(how.change.also)}"))


def show_taken_back(found: FixTry) -> None:
    """Say that the old value is back, or that a person has to set it."""
    change = f"{found.name} {exact(found.new)} -> {exact(found.old)}"
    if found.path is None:
        click.echo(plain(f"set it back yourself: {change}"))
    else:
        click.echo(plain(f"taken back: {found.path}: {change}"))


def state_document(state: FixState, file: Path) -> dict[str, object]:
    """The state as JSON, without what the missions say."""
    return {
        "file": str(file),
        "state": state.stand,
        "why": state.why,
        "mission": str(state.mission),
        "most": state.most,
        "go_on": state.go_on,
        "tries": [one.to_json() for one in state.tries],
        "run_again": run_again(state.mission),
    }


def document(
    talk: Conversation, file: Path, proposal: Proposal | None, how: Setting | None
) -> dict[str, object]:
    """The answer as JSON."""
    state = talk.judged
    left = [{"parameter": name, "probability": part} for name, part in talk.odds.ordered]
    return {
        **state_document(state, file),
        "suspects": left,
        "none": talk.odds.none,
        "proposal": None if proposal is None else _proposed(proposal, how),
    }


def _proposed(proposal: Proposal, how: Setting | None) -> dict[str, object]:
    found = proposal.would_be
    change = None if how is None or how.change is None else how.change
    said = found.to_json()
    kept = ("parameter", "name", "node", "old", "new", "basis", "text", "probability")
    return {
        **{name: said[name] for name in kept},
        "beyond": proposal.beyond,
        "by_hand": "" if how is None else how.by_hand,
        "file": None
        if change is None
        else {
            **change_as_json(change),
            "old": to_json(change.old),
            "new": to_json(change.new),
        },
    }
