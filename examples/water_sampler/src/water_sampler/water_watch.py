"""Whether the tube's tip is in the water, and what the pump says."""

import rospy

from water_sampler.msg import PumpStatus


class WaterWatch:
    """Follows the pump control's status."""

    def __init__(self):
        self._wet_readings_needed = rospy.get_param("~wet_readings_needed", 15)
        self._dry_patience = rospy.get_param("~dry_patience", 6.0)
        self._status_timeout = rospy.get_param("~status_timeout", 8.0)
        self.status = None
        self.in_water = False
        self._last_wet = None

    def update(self, status):
        """Take in a PumpStatus."""
        self.status = status
        # A drop that the rotors throw up wets the tip for a moment only.
        self.in_water = status.wet_readings >= self._wet_readings_needed
        if status.wet_readings > 0:
            self._last_wet = status.header.stamp

    def forget(self):
        """The tube is lowered anew."""
        self._last_wet = None

    def out_of_water(self, now):
        """Whether the tip has been dry for too long to go on."""
        if self._last_wet is None:
            return False
        return (now - self._last_wet).to_sec() > self._dry_patience

    def silent(self, now):
        """Whether the pump control is gone."""
        if self.status is None:
            return True
        return (now - self.status.header.stamp).to_sec() > self._status_timeout

    @property
    def vial_full(self):
        return self.status is not None and self.status.vial_full

    @property
    def pump_failed(self):
        return self.status is not None and self.status.fault != PumpStatus.OK
