#!/usr/bin/env python3
"""Make what is below a folder build with TPC: the script of the thesis (appendix A.3).

The thesis's script set compile and link flags for each executable. This one inserts three lines
that include tpc.cmake, which does so for every target, into each CMakeLists.txt that calls
project(), with a package.xml or without; ``--restore`` takes them out again.

It needs no Python package from outside Debian, unlike ``pytpc``.
"""

import argparse
import sys
from pathlib import Path

from pytpc.base.errors import TpcError
from pytpc.workspace.patch import run


def main() -> int:
    """The exit status: 0, 1 after an error that was shown as one line, 130 when interrupted."""
    parser = argparse.ArgumentParser(
        description="Put TPC's three lines at the top of each CMakeLists.txt that calls project(),"
        " or take them out again."
    )
    parser.add_argument("folder", type=Path, help="any folder")
    parser.add_argument("--restore", action="store_true", help="take the lines out again")
    parser.add_argument("--dry-run", action="store_true", help="show the difference only")
    chosen = parser.parse_args()
    try:
        run(chosen.folder, restore=chosen.restore, dry_run=chosen.dry_run, any_tree=True)
    except TpcError as error:
        print(f"pytpc: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
