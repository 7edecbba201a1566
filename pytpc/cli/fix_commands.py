"""The command ``fix``: tries values in turn until the robot is right, or nothing is left."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import click

from pytpc.api.fix_files import Setting
from pytpc.api.fix_state import STATE_FILE, FixState
from pytpc.api.fixing import Conversation, Proposal
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.cli.arguments import JSON, PATH, REFERENCE, as_object
from pytpc.cli.console import print_json
from pytpc.cli.fix_session import Consent, Session, alone_with
from pytpc.cli.fix_words import document, fix_words, show_next, show_stand, state_document
from pytpc.cli.options import STATIC, Seconds, offer_good_run
from pytpc.cli.value_commands import WORKSPACE
from pytpc.diagnosis.trying import MOST_TRIES, VERDICTS, Verdict


@dataclass(frozen=True)
class _FixArguments:
    mission: Path | None
    static_source: Path | None
    references: tuple[Path, ...]
    state_file: Path
    most: int | None
    go_on: bool
    yes: bool
    beyond: bool
    verdict: Verdict | None
    flown: Path | None
    command: str | None
    timeout_s: float | None
    undo: bool
    file: Path | None
    workspace: Path | None
    as_json: bool

    def __post_init__(self) -> None:
        if self.flown is not None and self.verdict is None:
            raise click.UsageError("--mission needs --say")
        if self.undo and (self.mission or self.verdict or self.command):
            raise click.UsageError("--undo goes without MISSION, --say and --command")
        if self.mission is not None and self.verdict is not None:
            raise click.UsageError("--say is about the last try: give its recording by --mission")
        if self.timeout_s is not None and self.command is None:
            raise click.UsageError("--timeout needs --command")

    @property
    def consent(self) -> Consent:
        """What is done without asking."""
        return Consent(self.yes, self.beyond, self.as_json, self.file)


@click.command("fix")
@click.argument("mission", type=PATH, required=False)
@STATIC
@REFERENCE
@click.option(
    "-o",
    "--output",
    "state_file",
    type=PATH,
    default=STATE_FILE,
    show_default=True,
    metavar="FILE",
    help="The file in which the tries are written down.",
)
@click.option(
    "--tries",
    "most",
    type=click.IntRange(min=1),
    metavar="N",
    help=f"Try at most so many values; may be raised later. [default: {MOST_TRIES}]",
)
@click.option(
    "--go-on",
    is_flag=True,
    help="Go on although it is likely none of the parameters; holds for later calls, too.",
)
@click.option("--yes", is_flag=True, help="Make the change without asking.")
@click.option(
    "--beyond", is_flag=True, help="Allow a value beyond the known range; --yes does not."
)
@click.option(
    "--say",
    "verdict",
    type=click.Choice(VERDICTS),
    help="What came of the last try; other: the error is gone, and another one came.",
)
@click.option(
    "--mission", "flown", type=PATH, metavar="RECORDING", help="The recording of that try."
)
@click.option(
    "--command",
    metavar="CMD",
    help="Run this shell command after each change; it records a mission into $TPC_FIX_MISSION,"
    " whose marks decide. Nothing is asked.",
)
@click.option(
    "--timeout",
    "timeout_s",
    type=Seconds(min=0.0, min_open=True, max=1e6),
    metavar="SECONDS",
    help="End a command that takes longer.",
)
@click.option("--undo", is_flag=True, help="Take back all changes, newest first.")
@click.option(
    "--file",
    type=PATH,
    metavar="FILE",
    help="Change this file, which the recording names though it is outside of the workspace.",
)
@WORKSPACE
@JSON
@as_object(_FixArguments)
def fix_command(given: _FixArguments) -> None:
    """Try one value after the other until the robot that went wrong in MISSION is right.

    The likeliest suspect with a value to try is changed in the file that set it. Run the mission
    again, and say what came of it. What did not help is taken back. Without MISSION, it shows where
    it stands and goes on.

    \b
    pytpc fix today --reference yesterday     propose a change, and ask
    pytpc fix --say same --mission again      it did not help; propose the next one
    pytpc fix --say fixed                     done
    pytpc fix --undo                          take back all changes
    """
    with alone_with(given.state_file):
        _fix(given)


COMMANDS: list[click.Command] = [fix_command]


def _fix(given: _FixArguments) -> None:
    session = _begun(given)
    if given.undo:
        _undo(session)
        return
    if given.verdict is not None:
        flown = None if given.flown is None else given.flown.absolute()
        session.check_is_open()
        if flown is not None:
            session.check_of_try(flown)
        session.say(given.verdict, flown)
    talk = session.talk()
    if given.mission is not None and not session.state.references:
        offer_good_run(session.state.mission)
    proposal, how = None, None
    if given.command is not None:
        talk = _unattended(session, talk, given.command, given.timeout_s)
    else:
        talk, proposal, how = _attended(session, talk)
    if given.as_json:
        print_json(document(talk, session.file, proposal, how))


def _begun(given: _FixArguments) -> Session:
    """The conversation of the state file, or a new one about MISSION.

    Raises:
        InputError: there is none and no MISSION, or it is about another mission.
    """
    file, mission = given.state_file, given.mission
    if mission is None or file.exists():
        state = FixState.load(file)
        if mission is not None and mission.absolute() != state.mission:
            raise InputError(
                f"is about {state.mission}; `{fix_words(file)}` goes on with it; for another"
                " mission give another -o FILE",
                file,
            )
    else:
        state = FixState(mission.absolute())
    if given.static_source is not None:
        state = replace(state, static=given.static_source.absolute())
    if given.references:
        state = replace(state, references=tuple(one.absolute() for one in given.references))
    if given.workspace is not None:
        state = replace(state, workspace=given.workspace.absolute())
    if given.most is not None:
        state = replace(state, most=given.most)
    if given.go_on:
        state = replace(state, go_on=True)
    return Session(file, state, given.consent)


def _undo(session: Session) -> None:
    """Take back all changes; the missions need not be there any more."""
    session.undo_all()
    if session.consent.quiet:
        print_json(state_document(session.state, session.file))
    elif not session.state.tries:
        click.echo("nothing was changed, so there is nothing to take back")


def _attended(
    session: Session, talk: Conversation
) -> tuple[Conversation, Proposal | None, Setting | None]:
    """Show where it stands, and propose the next change."""
    quiet = session.consent.quiet
    if not quiet:
        show_stand(talk, session.file)
    proposal, how, agreed = session.chosen(talk)
    if proposal is not None and how is not None and agreed:
        session.apply(proposal, how)
        talk = session.talk()
        proposal, how = None, None
    if quiet:
        return talk, proposal, how
    if session.state.open_try is not None:
        show_next(session.state, session.file)
    elif proposal is not None:
        click.echo(plain(f"nothing was changed; to try it: {fix_words(session.file, '--yes')}"))
    elif talk.judged.stand == "open":
        allowed = fix_words(session.file, "--beyond")
        click.echo(plain(f"only values beyond the known range are left; to try one: {allowed}"))
    return talk, proposal, how


def _unattended(
    session: Session, talk: Conversation, command: str, timeout_s: float | None
) -> Conversation:
    """Change, fly and judge until the robot is right, or until nothing is left to try."""
    while talk.judged.stand == "open":
        if session.state.open_try is None:
            proposal, how, agreed = session.chosen(talk, by_files=True)
            if proposal is None or how is None or not agreed:
                break
            session.apply(proposal, how)
            talk = session.talk()
        session.fly(talk, command, timeout_s)
        talk = session.talk()
    if not session.consent.quiet:
        show_stand(talk, session.file)
    return talk
