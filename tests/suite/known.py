"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

KNOWN: dict[str, str] = {}
