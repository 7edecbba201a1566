"""One call of ``pytpc fix``: it reads the missions, proposes, applies, and takes back."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import click

from pytpc.api import values
from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission
from pytpc.api.fix_command import free_folder, run_command
from pytpc.api.fix_files import Setting, apply_try, setting, take_back, with_change
from pytpc.api.fix_state import FixState, FixTry
from pytpc.api.fixing import Conversation, Proposal, missions_with_the_error, with_verdict
from pytpc.api.missions import find_declared, same_reports
from pytpc.api.values import Place
from pytpc.base.errors import InputError, TpcError
from pytpc.base.folder_lock import alone_in
from pytpc.base.wording import exact, plain, show
from pytpc.cli.console import progress, warn
from pytpc.cli.fix_words import fix_words, show_proposal, show_taken_back
from pytpc.cli.lines import say
from pytpc.cli.options import asked_mission, good_runs, recording_of, warn_plainly
from pytpc.cli.sources import static_for
from pytpc.cli.value_commands import is_terminal, with_consent
from pytpc.diagnosis.question import PLAIN
from pytpc.diagnosis.trying import TAKEN_BACK, Verdict, judged


@contextlib.contextmanager
def alone_with(file: Path) -> Iterator[None]:
    """Hold a state file against other calls of the command within the block.

    Raises:
        RunError: another one is at work with it.
        TpcError: its folder does not exist, or cannot be written.
    """
    folder = file.absolute().parent
    in_use = f"another `pytpc fix` works with {file.name}; wait until it ends, or give -o FILE"
    with contextlib.ExitStack() as held:
        try:
            held.enter_context(alone_in(folder, file.name, in_use))
        except OSError as error:
            raise TpcError(f"cannot be written: {error.strerror}", folder) from error
        yield


@dataclass(frozen=True)
class Consent:
    """What is done without asking: ``yes`` a usual change, ``beyond`` one beyond the known range.

    ``quiet`` asks nothing and shows nothing: a program reads the output. ``file`` is one that only
    the recording names and that the user confirmed.
    """

    yes: bool
    beyond: bool
    quiet: bool
    file: Path | None

    @property
    def asks(self) -> bool:
        """Whether somebody is there to be asked."""
        return not self.quiet and is_terminal()


@dataclass
class Session:
    """A conversation on the disk, and the missions of it that were read."""

    file: Path
    state: FixState
    consent: Consent
    _read: dict[Path, AskedMission] = field(default_factory=dict)
    _told: set[Path] = field(default_factory=set)

    def talk(self) -> Conversation:
        """What the missions and the tries say; where it stands is written down.

        Raises:
            InputError: the mission cannot be read, has no marks, or is of another robot.
            TpcError: the state cannot be written.
        """
        first = self._asked(self.state.mission)
        if not first.run.recording.marks:
            mark = f"pytpc mark {shlex.quote(str(self.state.mission))}"
            raise InputError(f"no marks: add some with `{mark}`", self.state.mission)
        later = {}
        for source in missions_with_the_error(self.state):
            if not source.exists():
                if source not in self._told:
                    self._told.add(source)
                    warn(plain(f"{source}: this recording of a try is gone; its marks are missing"))
                continue
            asked = self._asked(source)
            if asked.run.recording.marks:
                later[source] = asked
        talk = Conversation(self.state, first, later)
        with progress("replaying the missions"):
            self.save(talk.judged)
        return talk

    def save(self, state: FixState) -> None:
        """Write the state down."""
        state.save(self.file)
        self.state = state

    def _asked(self, source: Path) -> AskedMission:
        if source not in self._read:
            recording = recording_of(source)
            static = static_for(self.state.static, source, recording)
            question = replace(PLAIN, declared=find_declared(static, source, warn_plainly))
            good = good_runs(self.state.references, static)
            run = RecordedRun(recording, source)
            self._read[source] = asked_mission(run, static, question, good)
        return self._read[source]

    def check_is_open(self) -> FixTry:
        """The open try.

        Raises:
            InputError: there is none.
        """
        found = self.state.open_try
        if found is None:
            raise InputError(
                f"no try is open, so there is nothing to say; `{fix_words(self.file)}` proposes"
                " one",
                self.file,
            )
        return found

    def say(self, verdict: Verdict, mission: Path | None) -> None:
        """Take in a word about the open try, with its recording if there is one.

        Raises:
            InputError: no try is open.
            TpcError: the file was changed since, so that the value is not taken back.
        """
        found = self.check_is_open()
        said = replace(found, verdict=verdict, mission=mission)
        if verdict in TAKEN_BACK:
            said = self._taken_back(said)
        self.save(with_verdict(self.state, said))

    def check_of_try(self, mission: Path) -> None:
        """Check that a person has given the recording of the last try.

        Raises:
            InputError: it is that of an earlier one, or of another robot, or cannot be read.
        """
        own = self._asked(mission).run.recording
        earlier = (one.mission for one in self.state.tries if one.mission is not None)
        for source in (self.state.mission, *earlier):
            if source.exists() and same_reports(self._asked(source).run.recording, own):
                raise InputError(
                    f"has the same reports as {source}; give the recording of the last try", mission
                )

    def _taken_back(self, found: FixTry) -> FixTry:
        back = take_back(found, values.journal())
        if not self.consent.quiet:
            show_taken_back(back)
        return back

    def undo_all(self) -> None:
        """Take back all changes, newest first; each is written down at once.

        Raises:
            TpcError: a file was changed since; what was taken back before that stays so.
        """
        for place in reversed(range(len(self.state.tries))):
            if not self.state.tries[place].undone:
                back = self._taken_back(self.state.tries[place])
                self.save(replace(self.state.with_try(back, place), stand="open", why=""))

    def chosen(
        self, talk: Conversation, *, by_files: bool = False
    ) -> tuple[Proposal | None, Setting | None, bool]:
        """The change to try, how it is made, and whether it is agreed to.

        Args:
            talk: what the tries say.
            by_files: pass over what a person would have to set.
        """
        asks = not by_files and not self.consent.yes and self.consent.asks
        for proposal, how in self._settings(talk):
            if by_files and how.change is None:
                say(plain(f"passed over: {how.by_hand}"))
                continue
            if proposal.beyond and not self.consent.beyond:
                if not asks:
                    far = f"{proposal.would_be.text} is {proposal.beyond}"
                    say(plain(f"passed over: {far}; --beyond allows it"))
                    continue
                show_proposal(proposal, how)
                if click.confirm(f"It is {proposal.beyond}. Try it all the same?", err=True):
                    return proposal, how, True
                continue
            if not self.consent.quiet:
                show_proposal(proposal, how)
            if by_files or self.consent.yes:
                return proposal, how, True
            answer = _asked_about() if asks else "q"
            if answer != "n":
                return proposal, how, answer == "y"
        return None, None, False

    def _settings(self, talk: Conversation) -> Iterator[tuple[Proposal, Setting]]:
        for proposal in talk.proposals():
            found = proposal.would_be
            place = Place(self.state.mission, {}, self.state.workspace, self.consent.file)

            def planned(
                place: Place, proposal: Proposal = proposal, found: FixTry = found
            ) -> Setting:
                return setting(place, found.name, proposal.origin, found.new)

            asks = self.consent.asks and not self.consent.yes
            yield proposal, with_consent(place, planned, asks=asks)

    def apply(self, proposal: Proposal, how: Setting) -> None:
        """Make a change, and write it down before and after.

        Raises:
            TpcError: the file, or the state, cannot be written.
        """
        found = with_change(proposal.would_be, how.change)
        before = self.state
        self.save(replace(before, tries=(*before.tries, found), stand="open", why=""))
        if how.change is None:
            return
        try:
            found = apply_try(how.change, values.journal(), found)
        except Exception:
            self.save(before)
            raise
        self.save(self.state.with_try(found))

    def fly(self, talk: Conversation, command: str, timeout_s: float | None) -> None:
        """Have a command fly the open try, and judge it by the marks of its recording.

        Raises:
            RunError: the command fails; the try stays open.
            InputError: its recording cannot be read; the same.
        """
        found, number = self.check_is_open(), len(self.state.tries)
        if found.path is None:
            raise InputError(
                f"the open try is set by hand; end it with `{fix_words(self.file)} --say`",
                self.file,
            )
        mission = free_folder(self.file, number).absolute()
        what = f"try {number}: {found.name} {show(found.old)} -> {exact(found.new)}"
        say(plain(f"pytpc: {what}: running the command"))
        run_command(command, number, mission, timeout_s)
        verdict = judged(talk.marks, self._asked(mission).run.recording.marks)
        say(plain(f"pytpc: {what}: {verdict}"))
        self.say(verdict, mission)


def _asked_about() -> str:
    """What a person says of a proposal: ``y``, ``n`` for the next one, or ``q``."""
    words = "Try it: y(es), n(ext suspect) or q(uit)?"
    choice = click.Choice(["y", "n", "q"], case_sensitive=False)
    return str(click.prompt(words, "q", type=choice, show_choices=False, err=True))
