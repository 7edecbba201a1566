"""The places of a graph at which a robot can go wrong, and how an observer chooses one."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from pytpc.base.wording import plain
from pytpc.recording.graph_file import read_recorded_graph
from pytpc.recording.marks import MarkMessages, is_place
from pytpc.static.graph_names import (
    OWN_SERVICES,
    OWN_TOPICS,
    action_names,
    action_of,
    is_hidden,
    robots,
)
from pytpc.static.wiring import Connections

_MOST_PLACES = 1000
_LONGEST_ABOUT = 80
_LONGEST_TYPED = 255
_LONGEST_SHOWN = 60
_OWN_TYPES = {"dynamic_reconfigure/Config", "dynamic_reconfigure/ConfigDescription"}


class Place(NamedTuple):
    """A name of the graph, and what it is: the type of a topic, or ``action``, ``service``,
    ``node``."""

    name: str
    about: str

    def __str__(self) -> str:
        return f"{self.name} ({self.about})" if self.about else self.name


def places_of(graph: Connections) -> tuple[Place, ...]:
    """The places worth naming: topics that nodes of the robot publish, services, then nodes.

    Topics to which somebody listens come first. An action is one place, whatever topics it has.
    ROS's own names are left out, and all that are no ROS names.
    """
    actions = {
        name: f"action {kind}"[:_LONGEST_ABOUT].rstrip()
        for name, kind in action_names(graph.topics).items()
    }
    heard: set[Place] = set()
    unheard: set[Place] = set()
    services: set[Place] = set()
    nodes: set[str] = set()
    for name, topic in graph.topics.items():
        publishers, subscribers = robots(topic.publishers), robots(topic.subscribers)
        nodes |= publishers | subscribers
        action = action_of(name, actions)
        if action is not None:
            heard.add(Place(action, actions[action]))
        elif publishers and not _is_own_topic(name, topic.type):
            place = Place(name, (topic.type or "topic")[:_LONGEST_ABOUT])
            (heard if subscribers else unheard).add(place)
    for name, providers in graph.services.items():
        offering = robots(providers)
        nodes |= offering
        if offering and name.rpartition("/")[2] not in OWN_SERVICES:
            services.add(Place(name, "service"))
    parts = heard, unheard, services, {Place(name, "node") for name in nodes}
    found: dict[str, Place] = {}
    for part in parts:
        for place in sorted(part):
            if is_place(place.name) and not is_hidden(place.name):
                found.setdefault(place.name, place)
    return tuple(found.values())[:_MOST_PLACES]


def recorded_places(folder: Path) -> tuple[Place, ...]:
    """The places of the graph of a mission, by its folder; none if that was not recorded.

    Raises:
        InputError: the file of the graph is broken.
    """
    return places_of(read_recorded_graph(folder))


def _is_own_topic(name: str, kind: str | None) -> bool:
    is_mark = MarkMessages.message_type(name) is not None
    return is_mark or name in OWN_TOPICS or kind in _OWN_TYPES


class Naming(NamedTuple):
    """A place that is being chosen: from ``places``, which keep their numbers, by what is typed."""

    places: tuple[Place, ...] = ()
    typed: str = ""

    def type(self, key: str) -> Naming:
        """What is typed after a key; keys that type nothing change nothing."""
        if key == "backspace":
            return self._replace(typed=self.typed[:-1])
        if len(key) == 1 and key.isprintable() and len(self.typed) < _LONGEST_TYPED:
            return self._replace(typed=self.typed + key)
        return self

    def found(self) -> list[tuple[int, Place]]:
        """The places that fit what is typed, with their numbers; the best first.

        That is the whole name, then the beginning of one, then a part of one.
        """
        numbered = list(enumerate(self.places, start=1))
        wanted = self.typed.strip().lower()
        if self._number is not None or not wanted:
            return numbered
        fitting = [one for one in numbered if wanted in one[1].name.lower()]
        return sorted(fitting, key=lambda one: _distance(one[1].name.lower(), wanted))

    def chosen(self) -> str:
        """The place that Enter takes; empty where nothing is typed.

        A name with ``@`` before it is taken as it is.

        Raises:
            ValueError: it is none; a line that says why.
        """
        typed = self.typed.strip()
        if self._number is not None:
            if not 1 <= self._number <= len(self.places):
                raise ValueError(f"no place has this number: {_short(typed)}")
            return self.places[self._number - 1].name
        found = self.found()
        if typed and found and not typed.startswith("@"):
            return found[0][1].name
        name = typed.removeprefix("@")
        if typed and not is_place(name):
            raise ValueError(f"not a ROS name: {_short(name)}")
        return name

    def lines(self, most: int) -> list[str]:
        """At most so many lines that show what there is to choose; ``>`` is what Enter takes."""
        found = self.found()
        if not found:
            why = "no place is known" if not self.places else "no known place fits"
            what = "Enter takes the name as it is" if self.typed.strip() else "type a name"
            return [f"  {why}: {what}"][:most]
        room = most if len(found) <= most else max(1, most - 1)
        number = self._number
        first = 0 if number is None else max(0, min(number, len(found)) - room)
        taken = number if number is not None else (found[0][0] if self.typed.strip() else None)
        shown = [
            f"{'>' if number == taken else ' '}{number:3} {place}"
            for number, place in found[first : first + room]
        ]
        if len(found) > room:
            shown.append(f"     {len(found) - room} more: type a part of the name")
        return shown[:most]

    @property
    def _number(self) -> int | None:
        typed = self.typed.strip()
        is_number = self.places and typed.isascii() and typed.isdigit()
        return int(typed[:9]) if is_number else None


def _distance(name: str, wanted: str) -> int:
    """How far a name with ``wanted`` in it is from being it."""
    names = name, name.lstrip("/~")
    if wanted in names:
        return 0
    return 1 if any(one.startswith(wanted) for one in names) else 2


def _short(text: str) -> str:
    return plain(text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}...")
