"""What would keep a build with TPC from working, found before it is started.

``machine`` and ``workspace`` have the checks, which are functions of what ``look`` has seen.
"""
