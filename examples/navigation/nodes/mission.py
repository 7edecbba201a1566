#!/usr/bin/env python3
"""The mission as it should be."""

from navigation.mission import main

if __name__ == "__main__":
    main()
