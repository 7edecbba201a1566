"""The tables and figures of the thesis's study, from any recorded missions.

``missions`` reads a study; ``runtime``, ``marked``, ``delays`` and ``found`` work out table 6.12,
6.13 with 6.15, 6.14 and 6.16; ``thesis_tables`` gathers them, also for a notebook
(``notebook_tables``). ``states``, ``bars`` and ``curves`` draw.
"""
