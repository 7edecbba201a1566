"""The settings of a running node of ROS 1: its parameters, and the service that reads them."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime.config import NAMES, PARAMETERS, Config, parsed, text_of, variable_of
from pytpc.python_runtime.errors import warn

if TYPE_CHECKING:
    from io import BytesIO

    from pytpc.python_runtime.runtime import Runtime

_PLACES = ("/tpc", "~tpc")
_TYPE = "std_srvs/Trigger"
_MD5 = "937c9679a518e3a18d831e57125ea522"
_SERVICE = "~tpc/reload"


class Control:
    """Applies ``/tpc/NAME`` and then ``~tpc/NAME``, so that the node's own parameter wins."""

    def __init__(self, runtime: Runtime, ros: Any) -> None:  # noqa: ANN401
        """``ros`` is rospy, whose node is up."""
        self._runtime = runtime
        self._ros = ros
        self._of_environment = runtime.config
        self._told: list[str] = []

    def begin(self) -> None:
        """Apply the parameters once, and serve ``~tpc/reload``.

        Raises:
            Exception: rospy's own, where the master does not answer.
        """
        self.take_over()
        service, answer = _trigger()

        def reload(_request: object) -> object:
            complaints = self.take_over()
            message = "".join(f"{complaint}; " for complaint in complaints)
            return answer(not complaints, message + self._runtime.status())

        self._ros.Service(_SERVICE, service, reload)

    def take_over(self) -> list[str]:
        """Apply the parameters, and warn of those newly invalid; return all warnings."""
        complaints: list[str] = []
        now = self._runtime.config
        new = self._of_environment
        for place in _PLACES:
            folder = self._ros.resolve_name(place)
            found = self._ros.get_param(place, None)
            if found is None:
                continue
            if not isinstance(found, dict):
                complaints.append(
                    f"the parameter {folder} is not a namespace of parameters and is ignored"
                )
                continue
            for name, value in sorted(found.items()):
                new, complaint = _changed(new, now, name, value)
                if complaint:
                    complaints.append(f"the parameter {folder}/{name} is ignored: {complaint}")
        if not self._runtime.apply(new):
            complaints.append("the settings cannot be applied; the previous ones stay")
        # Who calls the service again and again does not fill the node's output.
        for complaint in complaints:
            if complaint not in self._told:
                warn(complaint)
        self._told = complaints
        return complaints


def _changed(new: Config, now: Config, name: str, value: object) -> tuple[Config, str]:
    """``new`` with one more setting; with ``now``'s, and the reason, where the value is invalid."""
    if name not in NAMES:
        return new, "there is no such setting"
    if name not in PARAMETERS:
        return new, f"only the environment of the node sets it ({variable_of(name)})"
    text = text_of(name, value)
    change, why = (None, "it is of the wrong type") if text is None else parsed(name, text)
    if change is not None:
        return new._replace(**change), ""
    field = "period_ns" if name == "period" else name
    held: dict[str, Any] = {field: getattr(now, field)}
    return new._replace(**held), why


def _trigger() -> tuple[Any, Any]:
    """The class of the service and that of its answer, as rospy expects them.

    They are defined here because std_srvs is not installed on every machine. The request of
    std_srvs/Trigger is empty; its answer is a byte for success and a text after its length.

    Raises:
        ImportError: genpy is not installed, and so rospy is not either.
    """
    import genpy  # noqa: PLC0415

    class Request(genpy.Message):  # type: ignore[misc]
        """No fields."""

        _md5sum, _type, _has_header, _full_text = _MD5, f"{_TYPE}Request", False, ""
        __slots__ = ()
        _slot_types = ()

        def serialize(self, buff: BytesIO) -> None:
            """Write nothing."""

        def deserialize(self, _text: bytes) -> object:
            """Read nothing."""
            return self

    class Response(genpy.Message):  # type: ignore[misc]
        """Whether it succeeded, and a message."""

        _md5sum, _type, _has_header = _MD5, f"{_TYPE}Response", False
        _full_text = "bool success\nstring message\n"
        __slots__ = ("message", "success")
        _slot_types = ("string", "bool")

        def __init__(self, success: bool = False, message: str = "") -> None:
            self.success = success
            self.message = message

        def serialize(self, buff: BytesIO) -> None:
            """Write both."""
            raw = self.message.encode("utf-8")
            buff.write(struct.pack("<BI", self.success, len(raw)) + raw)

        def deserialize(self, text: bytes) -> object:
            """Read both."""
            success, length = struct.unpack_from("<BI", text)
            self.success = bool(success)
            self.message = text[5 : 5 + length].decode("utf-8", "replace")
            return self

    class Trigger:
        """The service."""

        _type, _md5sum = _TYPE, _MD5
        _request_class, _response_class = Request, Response

    return Trigger, Response
