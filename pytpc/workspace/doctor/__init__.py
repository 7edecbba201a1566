"""What would keep a build with TPC from working, found before it is started.

``machine`` checks what ``look`` has seen of the machine; ``workspace`` looks at a workspace and
checks it.
"""
