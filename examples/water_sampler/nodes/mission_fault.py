#!/usr/bin/env python3
"""The mission with one wrong comparison: the thesis's third treatment."""

from water_sampler.mission import main
from water_sampler.states import STATES, Dip


class FaultyDip(Dip):
    """Asks for more than the depth that must not be passed."""

    def deep_enough(self, depth):
        return depth > self._max_dip_depth


if __name__ == "__main__":
    main([FaultyDip if state is Dip else state for state in STATES])
