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
        low = self.voltage < self._return_voltage
        self._readings = self._readings + 1 if low else 0

    @property
    def weak(self):
        """Whether it is low for more than a moment."""
        return self._readings >= self._weak_readings

    @property
    def full(self):
        """Whether it is enough to begin."""
        return self.voltage > self._min_start_voltage
