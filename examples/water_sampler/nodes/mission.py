#!/usr/bin/env python3
"""The mission as it should be."""

from water_sampler.mission import main

if __name__ == "__main__":
    main()
