"""Finds what would keep a build with TPC from working, before it is started.

``machine`` and ``workspace`` look first; their checks are functions of what was seen.
"""
