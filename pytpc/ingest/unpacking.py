"""Unpacks the chunks of bags, and refuses those that would fill the memory.

The limits are far above what a robot can record: one chunk, one message, and how much larger all
chunks together may be than they are in the file. None of them is on the length of a mission.
"""

from __future__ import annotations

import bz2
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, BinaryIO

from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]

if TYPE_CHECKING:
    from typing_extensions import Self

LARGEST_CHUNK = 1 << 29
LARGEST_MESSAGE = 1 << 26
"""Of those that hold reports or marks; images may be larger and are not read."""
MOST_MESSAGES = 1 << 21
"""In one chunk; a recorder begins a new one after less than 20,000."""
_RATIO = 2000
_ANY_CHUNK = 1 << 25
_ANY_FILE = 1 << 28


class UnpackingError(ValueError):
    """A chunk that is broken, or would be too large."""


class Unpacker:
    """Unpacks the chunks of one file."""

    def __init__(self) -> None:
        self._packed = 0
        self._unpacked = 0

    def unpack(self, data: bytes, compression: str, size: int) -> bytes:
        """The content of a chunk, which says that it has ``size`` bytes.

        Raises:
            UnpackingError: it is broken, of an unknown compression, or too large.
        """
        self._check(len(data), size)
        _check_chunk(len(data), size)
        try:
            unpacked = _unpacked(data, compression, size)
        except Exception as error:
            # Each of the libraries has errors of its own.
            raise UnpackingError(str(error)) from error
        if len(unpacked) != size:
            raise UnpackingError(f"a chunk of {len(unpacked)} bytes, not {size}")
        return unpacked

    def unpack_message(self, data: bytes) -> bytes:
        """A message that was compressed by itself (zstd).

        Raises:
            UnpackingError: it is broken or too large.
        """
        try:
            unpacked = bytes(_zstd().ZstdDecompressor().decompress(data, LARGEST_MESSAGE + 1))
        except (_zstd().ZstdError, ValueError, EOFError) as error:
            raise UnpackingError(str(error)) from error
        if len(unpacked) > LARGEST_MESSAGE:
            raise UnpackingError(f"a message of more than {LARGEST_MESSAGE:,} bytes")
        self._check(len(data), len(unpacked))
        return unpacked

    def _check(self, packed: int, size: int) -> None:
        self._packed += packed
        self._unpacked += size
        _check_ratio(self._packed, self._unpacked, _ANY_FILE)


class UnpackedStream:
    """The content of a file that was compressed as a whole (zstd)."""

    def __init__(self, packed: BinaryIO) -> None:
        self._packed = packed
        self._stream = _zstd().open(packed, "rb")
        self._unpacked = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()

    def read(self, count: int) -> bytes:
        """The next bytes.

        Raises:
            UnpackingError: they are too many for the size of the file.
        """
        data = bytes(self._stream.read(count))
        self._unpacked += len(data)
        _check_ratio(self._packed.tell(), self._unpacked, _ANY_FILE)
        return data


def _check_chunk(packed: int, size: int) -> None:
    if size > LARGEST_CHUNK:
        raise UnpackingError(f"a chunk of {size:,} bytes; at most {LARGEST_CHUNK:,} are read")
    _check_ratio(packed, size, _ANY_CHUNK)


def _check_ratio(packed: int, unpacked: int, floor: int) -> None:
    if unpacked > max(floor, _RATIO * packed):
        raise UnpackingError(
            f"{packed:,} bytes that unpack to {unpacked:,}, more than {_RATIO} times as much"
        )


@cache
def _zstd() -> Any:  # noqa: ANN401 - rosbags brings one or the other
    try:
        return import_module("compression.zstd")
    except ImportError:
        return import_module("backports.zstd")


def _unpacked(data: bytes, compression: str, size: int) -> bytes:
    # One byte more than expected shows that there is more.
    if compression in {"", "none"}:
        return data
    if compression == "bz2":
        return bz2.BZ2Decompressor().decompress(data, size + 1)
    if compression == "lz4":
        return bytes(LZ4FrameDecompressor().decompress(data, size + 1))
    if compression == "zstd":
        return bytes(_zstd().ZstdDecompressor().decompress(data, size + 1))
    raise ValueError(f"compression {compression!r}")
