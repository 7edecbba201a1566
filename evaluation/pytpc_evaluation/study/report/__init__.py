"""The study's page: every table and figure from the study's folder.

``judging`` lets the methods rank what is not ranked yet; ``folder`` and ``positions`` read;
``parts`` says what is judged together; ``systems``, ``changed``, ``original``, ``ranked``,
``confidence`` and ``repairs`` work out tables; ``charts`` and ``drawings`` draw; ``page`` puts them
together; ``making`` writes the files. ``thesis_figures`` has the thesis's own numbers.
"""
