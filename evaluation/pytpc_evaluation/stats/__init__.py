"""The tables and figures of the thesis's study (SPEC 9), from any recorded missions.

``missions`` reads a study; ``runtime``, ``marked``, ``delays`` and ``found`` work out table 6.12,
6.13 with 6.15, 6.14 and 6.16; ``study`` gathers them. ``states``, ``bars`` and ``curves`` draw.
"""
