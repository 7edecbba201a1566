"""The report page: ``write_report(path, [MissionReport(...)])`` makes one self-contained file."""

from pytpc.report.html import MissionReport, write_report

__all__ = ["MissionReport", "write_report"]
