"""Asks the pump control to run the pump."""

import rospy

from water_sampler.srv import RunPump


class PumpClient:
    """Asks again while the pump control refuses, but not for ever."""

    def __init__(self):
        self._retry_period = rospy.get_param("~pump_retry_period", 1.0)
        self._max_requests = rospy.get_param("~max_pump_requests", 5)
        self._vial = rospy.get_param("~vial", 0)
        self._run = rospy.ServiceProxy("/pump/run", RunPump)
        self._asked = None
        self.requests = 0
        self.started = False

    @property
    def hopeless(self):
        """Whether it was refused so often that asking again is no use."""
        return not self.started and self.requests >= self._max_requests

    def start(self, now):
        """Ask, unless it was asked just now."""
        if self.started:
            return
        if self._asked is not None and (now - self._asked).to_sec() < self._retry_period:
            return
        self._asked = now
        self.requests += 1
        self.started = self._call(True)

    def stop(self):
        """Have the pump stand still."""
        if self.started:
            self._call(False)
        self.started = False

    def _call(self, run):
        try:
            answer = self._run(run=run, vial=self._vial)
        except rospy.ServiceException as error:
            rospy.logwarn("the pump control does not answer: %s", error)
            return False
        if not answer.accepted:
            rospy.loginfo("the pump control refuses: %s", answer.reason)
        return answer.accepted
