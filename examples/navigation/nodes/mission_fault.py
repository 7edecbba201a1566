#!/usr/bin/env python3
"""The mission with one wrong comparison: a fault in the source."""

from navigation.battery_watch import BatteryWatch
from navigation.mission import main


class FaultyBatteryWatch(BatteryWatch):
    """Takes a good battery for a weak one."""

    def low(self):
        return self.voltage > self._return_voltage


if __name__ == "__main__":
    main(battery=FaultyBatteryWatch)
