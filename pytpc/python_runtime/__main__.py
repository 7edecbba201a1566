"""``python -m pytpc.python_runtime NODE.py`` runs a Python node with reports."""

from pytpc.python_runtime.run import main

main()
