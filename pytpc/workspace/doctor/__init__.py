"""Finds what would keep a build with TPC from working, before it is started.

``machine`` checks what ``look`` has seen of the machine; ``workspace`` looks at a workspace and
checks it.
"""
