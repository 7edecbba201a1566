"""The study's page: every table and figure from the study's folder.

``folder`` and ``positions`` read; ``systems``, ``original``, ``ranked``, ``confidence`` and
``repairs`` work out tables; ``charts`` and ``drawings`` draw; ``page`` puts them together;
``making`` writes the files. ``thesis_figures`` has the thesis's own numbers.
"""
