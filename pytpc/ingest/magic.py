"""The first bytes of the files of each format."""

from __future__ import annotations

from pytpc.python_runtime.log_layout import MAGIC as TPC_MAGIC

__all__ = ["BAG_MAGIC", "MCAP_MAGIC", "PARQUET_MAGIC", "SQLITE_MAGIC", "TPC_MAGIC"]

BAG_MAGIC = b"#ROSBAG V2.0\n"
MCAP_MAGIC = b"\x89MCAP0\r\n"
PARQUET_MAGIC = b"PAR1"
SQLITE_MAGIC = b"SQLite format 3\0"
