#!/usr/bin/env python3
"""Make what is below a folder build with TPC: the script of the thesis (appendix A.3).

Usage: modify_cmakelists.py DIR [--restore] [--dry-run]

The thesis's script set compile and link flags for each executable. This one inserts three lines
that include tpc.cmake, which does so for every target, into each CMakeLists.txt that calls
project(), with a package.xml or without; ``--restore`` takes them out again.
"""

import sys

from pytpc.workspace.patch import main

if __name__ == "__main__":
    sys.exit(main(program="modify_cmakelists.py", any_tree=True))
