"""Whether the battery still takes the robot to the goal and back."""

import rospy


class BatteryWatch:
    """Smooths the readings: under load they sag."""

    def __init__(self):
        self._min_start_voltage = rospy.get_param("~min_start_voltage", 11.8)
        self._return_voltage = rospy.get_param("~return_voltage", 11.2)
        self._weak_readings = rospy.get_param("~weak_readings", 10)
        self._readings = 0
        self.voltage = 0.0

    def update(self, voltage):
        """Take in a reading, in V."""
        if self.voltage == 0.0:
            self.voltage = voltage
        self.voltage += 0.1 * (voltage - self.voltage)
        self._readings = self._readings + 1 if self.low() else 0

    def low(self):
        """Whether it is time to go home."""
        return self.voltage < self._return_voltage

    @property
    def weak(self):
        """Whether it is low for more than a moment."""
        return self._readings >= self._weak_readings

    @property
    def full(self):
        """Whether it is enough to begin."""
        return self.voltage > self._min_start_voltage
