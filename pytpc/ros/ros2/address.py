"""The address of a ROS 2 graph: its domain, and how its nodes find one another.

It stands where that of a ROS 1 master would: ``ros2://7`` or
``ros2://7?ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from urllib.parse import parse_qsl, urlencode

from pytpc.base.errors import InputError

SCHEME = "ros2://"
DOMAIN = "ROS_DOMAIN_ID"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
MOST_DOMAINS = 232
VARIABLES = (
    "RMW_IMPLEMENTATION",
    RANGE,
    "ROS_STATIC_PEERS",
    "ROS_LOCALHOST_ONLY",
    "ROS_DISCOVERY_SERVER",
)


class Ros2Address(NamedTuple):
    """A graph of ROS 2.

    ``settings`` are the variables of the environment that decide who finds whom.
    """

    domain: str
    settings: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of_env(cls, env: Mapping[str, str]) -> Ros2Address:
        """The graph on which a node of this environment would be.

        Raises:
            InputError: ROS_DOMAIN_ID is none.
        """
        domain = env.get(DOMAIN) or "0"
        # rcl takes -1 for 0, and DDS has no ports for more than these.
        number = domain.lstrip("0") or "0"
        is_number = domain.isascii() and domain.isdigit() and len(number) <= len(str(MOST_DOMAINS))
        if not is_number or int(number) > MOST_DOMAINS:
            raise InputError(f"{DOMAIN}={domain}: give a number from 0 to {MOST_DOMAINS}")
        found = tuple((name, env[name]) for name in VARIABLES if env.get(name))
        return cls(number, found)

    @classmethod
    def parse(cls, text: str) -> Ros2Address:
        """The graph of an address; see ``is_ros2``."""
        domain, _, rest = text.removeprefix(SCHEME).partition("?")
        return cls(domain, tuple((a, b) for a, b in parse_qsl(rest) if a in VARIABLES))

    def __str__(self) -> str:
        rest = f"?{urlencode(self.settings)}" if self.settings else ""
        return f"{SCHEME}{self.domain}{rest}"

    @property
    def words(self) -> str:
        """Which graph it is, for a person."""
        rest = "".join(f"; {name}={value}" for name, value in self.settings)
        return f"ROS 2 domain {self.domain} ({DOMAIN}={self.domain}{rest})"

    def env(self, env: Mapping[str, str]) -> dict[str, str]:
        """An environment in which a node is on this graph."""
        kept = {name: value for name, value in env.items() if name not in VARIABLES}
        return {**kept, **dict(self.settings), DOMAIN: self.domain}


def is_ros2(address: str) -> bool:
    """Whether this is the address of a ROS 2 graph, not the URI of a ROS 1 master."""
    return address.startswith(SCHEME)


def words_of(address: str) -> str:
    """Which graph it is, for a person."""
    return Ros2Address.parse(address).words if is_ros2(address) else address
