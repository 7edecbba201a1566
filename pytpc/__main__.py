"""``python -m pytpc`` is ``pytpc``."""

from pytpc.cli.main import main

if __name__ == "__main__":
    main(prog_name="pytpc")
