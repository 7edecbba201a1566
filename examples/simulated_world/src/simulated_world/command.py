"""The command line that the observers of all robots have.

    observer.py --seed 1                                    live, as a ROS node
    observer.py --bag mission.bag --sights sights.parquet   from a bag to sights
    observer.py --sights sights.parquet --causes causes.json --marks marks.parquet --seed 1

Files need pyarrow and no running robot; a bag needs the Python of ROS, too.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from simulated_world.crowd import USERS, marks_of
from simulated_world.errors import ObserverError
from simulated_world.observer import Observer
from simulated_world.rules import SightT, causes_of


def main(observer: Observer[SightT], arguments: Sequence[str]) -> int:
    """Run an observer.

    Args:
        observer: of one robot.
        arguments: the command line without the program; what roslaunch adds is left to ROS.

    Returns:
        The exit status: 1, and one line on stderr, where a file is not as it has to be or a
        module is missing.
    """
    options = _parser().parse_args([text for text in arguments if ":=" not in text])
    try:
        if (options.bag, options.sights, options.causes, options.marks) == (None,) * 4:
            # Imported where they are needed: a robot has ROS, who reads a table may have none.
            from simulated_world.observer_node import watch  # noqa: PLC0415

            watch(observer, options.seed)
        else:
            _from_files(observer, options)
    except OSError as error:
        return _failed(f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except ObserverError as error:
        return _failed(str(error))
    except ModuleNotFoundError as error:
        return _failed(f"this Python ({sys.executable}) has no {error.name}")
    return 0


def _failed(text: str) -> int:
    print(f"{Path(sys.argv[0]).name}: {' '.join(text.split())}", file=sys.stderr)
    return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description="A scripted observer. Without a file: watches the robot live, as one person."
    )
    parser.add_argument("--seed", type=int, default=1, help="of all that is random (1)")
    parser.add_argument("--bag", type=Path, help="recorded mission (ROS 1 bag) to read")
    parser.add_argument(
        "--sights",
        type=Path,
        help="table of what was seen (Parquet): written with --bag, else read",
    )
    parser.add_argument("--causes", type=Path, help="what was wrong (JSON), to write")
    parser.add_argument("--marks", type=Path, help="when whom pressed a key (Parquet), to write")
    parser.add_argument(
        "--users",
        type=int,
        choices=range(1, len(USERS) + 1),
        default=len(USERS),
        help=f"how many of the thesis's users set marks ({len(USERS)})",
    )
    return parser


def _from_files(observer: Observer[SightT], options: argparse.Namespace) -> None:
    from simulated_world import marks_file  # noqa: PLC0415
    from simulated_world.sights import load_sights, save_sights  # noqa: PLC0415

    if options.sights is None:
        raise ObserverError("--sights is missing")
    if options.bag is None:
        sights = load_sights(options.sights, observer.sight)
    else:
        from simulated_world.bag import read_bag  # noqa: PLC0415

        sights = read_bag(options.bag, observer)
        save_sights(sights, observer.sight, options.sights)
    causes = causes_of(observer.rules(), sights)
    if options.causes is not None:
        marks_file.save_causes(causes, options.causes)
    if options.marks is not None:
        users = USERS[: options.users]
        # Who saw nothing of the robot has nothing to mark, rightly or wrongly.
        seen = (sights[0].time, sights[-1].time) if sights else None
        marks = marks_of(causes, *seen, options.seed, users) if seen else []
        marks_file.save_marks(marks, options.marks)
