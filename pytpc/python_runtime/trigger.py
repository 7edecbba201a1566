"""The service type std_srvs/Trigger, for machines on which its Python package is not installed.

Its request is empty; its answer is a byte of success and a text with its length before it.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from io import BytesIO

_TYPE = "std_srvs/Trigger"
_MD5 = "937c9679a518e3a18d831e57125ea522"


def trigger() -> tuple[Any, Any]:
    """The service's class and that of its answer, as rospy takes them.

    Raises:
        ImportError: genpy is not there, and so no rospy.
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
        """Whether it succeeded, and what there is to say."""

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
