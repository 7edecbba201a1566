"""The nodes of rclpy that the program makes; this module never imports rclpy.

The import hook calls `watch` with the module ``rclpy.node`` once the program has imported it. The
first node names the process (`ros2_nodes` tells the others apart); its clock gives the time, and
that of the next one when it is destroyed.
"""

from __future__ import annotations

import functools
import sys
import weakref
from time import time_ns
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from types import ModuleType

MODULE = "rclpy.node"
# How long it is not asked again whether time is simulated.
_ASK_NS = 10_000_000


class _Known:
    """A node: its name and domain stay known when it is destroyed."""

    __slots__ = ("clock", "domain", "name", "node")

    def __init__(self, node: Any, name: str, domain: int | None) -> None:  # noqa: ANN401
        self.node: Callable[[], Any] = weakref.ref(node)
        self.clock: Any = node.get_clock()
        self.name = name
        self.domain = domain

    def is_alive(self) -> bool:
        """Whether it is not destroyed."""
        node = self.node()
        try:
            with node.handle:
                return True
        except Exception:
            # It is collected, or its handle is invalid.
            return False


class _State:
    """Of this process."""

    nodes: list[_Known] = []  # noqa: RUF012
    clock: Any = None
    is_simulated = False
    asked_at = 0
    kind: Any = None
    # Of those nodes, by `id`; nodes that are no more may have left theirs.
    names: dict[int, str] = {}  # noqa: RUF012
    tell: Callable[[], None] | None = None


def tell(function: Callable[[], None]) -> None:
    """Call ``function`` whenever the program has made a node."""
    _State.tell = function


def watch(module: ModuleType) -> None:
    """Learn of each node, by the constructor that all kinds of nodes call."""
    kind: Any = module.Node
    _State.kind = kind
    construct = kind.__init__
    if hasattr(construct, "tpc_watches"):
        return

    @functools.wraps(construct)
    def __init__(self: Any, *args: Any, **options: Any) -> None:  # noqa: ANN401
        construct(self, *args, **options)
        if not hasattr(type(self), "is_of_tpc"):
            _came(kind, self)

    __init__.tpc_watches = True  # type: ignore[attr-defined]
    kind.__init__ = __init__


def watch_if_imported() -> None:
    """Watch where the program's interpreter has imported rclpy before the hook was there."""
    module = sys.modules.get(MODULE)
    if module is not None and hasattr(module, "Node"):
        watch(module)


def _came(kind: Any, node: Any) -> None:  # noqa: ANN401
    try:
        name = str(kind.get_fully_qualified_name(node))
        _forget_dead()
        _State.nodes.append(_Known(node, name, _domain_of(node)))
        _State.names[id(node)] = name
        _ask()
        if _State.tell is not None:
            _State.tell()
    except Exception:
        # What the hook wants to know must not stop the node.
        return


def _domain_of(node: Any) -> int | None:  # noqa: ANN401
    try:
        return int(node.context.get_domain_id())
    except Exception:
        # An older rclpy: it is that of the environment.
        return None


def _forget_dead() -> None:
    """Keep the first node, whose name is the process's, and those that are not destroyed."""
    first, others = _State.nodes[:1], _State.nodes[1:]
    _State.nodes[:] = first + [one for one in others if one.is_alive()]


def has_node() -> bool:
    """Whether the program has made a node."""
    return _State.clock is not None


def name() -> str:
    """The fully qualified name of the first node."""
    return _State.nodes[0].name


def has_several() -> bool:
    """Whether more than one node was made."""
    return len(_State.nodes) > 1


def kind() -> Any:  # noqa: ANN401
    """The class of all nodes."""
    return _State.kind


def name_of(node: object) -> str:
    """The fully qualified name of this node; empty if it is TPC's own."""
    return _State.names.get(id(node), "")


def name_of_owner(values: Iterable[object]) -> str:
    """The name of the node that has one of these timers, subscriptions and so on."""
    given = {id(each) for each in values}
    for known in list(_State.nodes):
        node = known.node()
        for owned in [] if node is None else list(vars(node).values()):
            if type(owned) is list and any(id(each) in given for each in owned):
                return known.name
    return ""


def domain() -> int | None:
    """The first node's domain; None where its rclpy does not say."""
    return _State.nodes[0].domain


def is_simulated() -> bool:
    """Whether the node's time is that of /clock."""
    _ask()
    return _State.is_simulated


def _ask() -> None:
    _State.asked_at = time_ns()
    alive = next((one for one in _State.nodes if one.is_alive()), None)
    if alive is not None:
        _State.clock = alive.clock
    elif _State.clock is None:
        _State.clock = _State.nodes[0].clock
    try:
        _State.is_simulated = bool(_State.clock.ros_time_is_active)
    except Exception:
        # The clock is no ROS clock, or was destroyed with its context.
        _State.is_simulated = False


def time_now_ns() -> int:
    """The node's time where it is simulated, else the wall clock's."""
    real = time_ns()
    if not 0 <= real - _State.asked_at < _ASK_NS:
        _ask()
    if not _State.is_simulated:
        return real
    try:
        return int(_State.clock.now().nanoseconds)
    except Exception:
        return 0
