"""Several people who watch one mission: from causes to marks, as the thesis's users set theirs.

The numbers are those of its image capture trials (tables 6.13, 6.14 and 6.15). A user who is as
slow, as eager and as often mistaken about the type as one of them marks a cause so:

* how late: one of his delays from the error to the first mark, a little varied;
* how often: one of his counts of marks in a trial with such an error, which may be 0;
* what he says: "I" or "II", confused as often as people confused them;
* where nothing at all went wrong: as many false alarms as in one of his clean trials.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from simulated_world.rules import KIND_I, KIND_II, Cause

FALSE_ALARM = -1

# Table 6.13: how often (I, II) was said in the treatments of each kind.
SAID: Mapping[str, tuple[int, int]] = {KIND_I: (2, 15), KIND_II: (26, 25)}

DELAY_SIGMA = 0.2  # of the factor's logarithm: no two delays of a person are the same
# Our own, the thesis has no table of it: from one mark of a cause to the user's next one, in s.
GAP_S: Mapping[str, tuple[float, float]] = {KIND_I: (1.0, 4.0), KIND_II: (4.0, 9.0)}


@dataclass(frozen=True)
class User:
    """What the tables say of one user.

    ``delays_s`` are his entries in table 6.14 by the kind of the treatment (1 is of kind I, 2 of
    kind II), ``counts`` his marks of both types in the two trials of it in table 6.15, and
    ``false_alarms`` those in the two clean trials (treatment 4).
    """

    name: str
    delays_s: Mapping[str, tuple[float, ...]]
    counts: Mapping[str, tuple[int, int]]
    false_alarms: tuple[int, int]


# Table 6.14 has three entries where one user set no mark; which one, is known from table 6.15:
# user 3 marked in the first trial of treatment 1 alone.
USERS = (
    User(
        "user1",
        delays_s={KIND_I: (11.69, 3.12), KIND_II: (6.99, 1.71)},
        counts={KIND_I: (0 + 3, 0 + 3), KIND_II: (6 + 1, 2 + 7)},
        false_alarms=(0, 2 + 1),
    ),
    User(
        "user2",
        delays_s={KIND_I: (25.07, 3.78), KIND_II: (12.37, 9.97)},
        counts={KIND_I: (0 + 1, 0 + 2), KIND_II: (3 + 1, 3 + 3)},
        false_alarms=(0, 1 + 1),
    ),
    User(
        "user3",
        delays_s={KIND_I: (11.45,), KIND_II: ()},
        counts={KIND_I: (0 + 2, 0), KIND_II: (0, 0)},
        false_alarms=(0, 0),
    ),
    User(
        "user4",
        delays_s={KIND_I: (21.63, 0.96), KIND_II: (12.07, 9.91)},
        counts={KIND_I: (0 + 2, 2 + 2), KIND_II: (10 + 1, 2 + 12)},
        false_alarms=(0, 2 + 0),
    ),
)


@dataclass(frozen=True)
class CrowdMark:
    """A key press: when, in ns of simulated time, and by whom.

    ``cause`` is the place of its cause in the list, or ``FALSE_ALARM``; ``right`` is the kind that
    was to be seen, of a false alarm a coin's; ``said`` is what the user took it for.
    """

    time_ns: int
    observer: str
    cause: int
    right: str
    said: str


def marks_of(
    causes: Sequence[Cause], begin: float, end: float, seed: int, users: Sequence[User] = USERS
) -> list[CrowdMark]:
    """The marks of all users, in the order of time.

    Args:
        causes: what was wrong in the mission.
        begin: first moment of the recording, s.
        end: last moment, s; what would be pressed later is lost.
        seed: of all that is random.
        users: who watches.
    """
    marks: list[CrowdMark] = []
    for user in users:
        for place, cause in enumerate(causes):
            # A cause's marks depend on it alone: another cause, earlier or later, changes none.
            same = sum(other == cause for other in causes[:place])
            dice = random.Random(f"{seed} {user.name} {cause.kind} {cause.start!r} {same}")
            marks += _marks_of_cause(user, dice, place, cause, end)
        if not causes:
            marks += _false_alarms(user, begin, end, seed)
    return sorted(marks, key=lambda mark: (mark.time_ns, mark.observer, mark.cause))


def _marks_of_cause(
    user: User, dice: random.Random, place: int, cause: Cause, end: float
) -> list[CrowdMark]:
    count = dice.choice(user.counts[cause.kind])
    time = cause.start + _delay(user, cause.kind, dice)
    # Where the robot went on at last, the hand leaves the key.
    last = min(cause.end, end) if cause.kind == KIND_II else end
    marks: list[CrowdMark] = []
    while len(marks) < count and time <= last:
        marks.append(_mark(user, dice, time, place, cause.kind))
        time += dice.uniform(*GAP_S[cause.kind])
    return marks


def _delay(user: User, kind: str, dice: random.Random) -> float:
    of_all = [delay for each in USERS for delay in each.delays_s[kind]]
    return dice.choice(user.delays_s[kind] or of_all) * dice.lognormvariate(0.0, DELAY_SIGMA)


def _false_alarms(user: User, begin: float, end: float, seed: int) -> list[CrowdMark]:
    dice = random.Random(f"{seed} {user.name} false alarm {begin!r} {end!r}")
    times = [dice.uniform(begin, end) for _ in range(dice.choice(user.false_alarms))]
    return [_mark(user, dice, time, FALSE_ALARM, dice.choice((KIND_I, KIND_II))) for time in times]


def _mark(user: User, dice: random.Random, time: float, cause: int, right: str) -> CrowdMark:
    said_i, said_ii = SAID[right]
    said = KIND_I if dice.random() * (said_i + said_ii) < said_i else KIND_II
    return CrowdMark(round(time * 1e9), user.name, cause, right, said)
