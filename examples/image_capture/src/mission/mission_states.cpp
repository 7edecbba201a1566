// What the mission does in each of its states.
#include <cmath>

#include <image_capture/CapturePicture.h>

#include "image_capture/limits.h"
#include "image_capture/mission_node.h"

namespace image_capture {

void MissionNode::runState() {
  switch (state_) {
  case MissionState::IDLE:
    return runIdle();
  case MissionState::TAKEOFF:
    return runTakeoff();
  case MissionState::GOTO:
    return runGoto();
  case MissionState::ALIGN:
    return runAlign();
  case MissionState::SEARCH:
    return runSearch();
  case MissionState::TRACK:
    return runTrack();
  case MissionState::RETURN:
    return runReturn();
  case MissionState::LAND:
    return runLand();
  case MissionState::ABORT:
    return runAbort();
  default:
    return sendWayPose(WayPose());
  }
}

void MissionNode::watchTime() {
  if (started_.isZero() || state_ == MissionState::DONE ||
      state_ == MissionState::ABORT || state_ == MissionState::LAND)
    return;
  if ((now_ - started_).toSec() > mission_timeout_)
    enter(MissionState::ABORT);
}

void MissionNode::runIdle() {
  sendWayPose(WayPose());
  const bool sensing = !flight_.header.stamp.isZero() && frame_rate_ > 0.0;
  if (!sensing)
    return;
  if (entered_.isZero())
    entered_ = now_;
  if ((now_ - entered_).toSec() < start_delay_)
    return;
  // A camera slower than the control loop would centre on stale images.
  if (frame_rate_ < selfie_control_rate_) {
    ROS_ERROR("the camera gives %.1f images a second, too few to take selfies",
              frame_rate_);
    enter(MissionState::DONE);
    return;
  }
  started_ = now_;
  enter(MissionState::TAKEOFF);
}

void MissionNode::runTakeoff() {
  flyTo(hold_x_, hold_y_, takeoff_height_, goal_yaw_);
  if (flight_.position.z > takeoff_height_ - 0.15)
    enter(MissionState::GOTO);
}

void MissionNode::runGoto() {
  const Point &point = route_[leg_];
  flyTo(point.x, point.y, takeoff_height_, goal_yaw_);
  if (legOverdue()) {
    enter(MissionState::ABORT);
    return;
  }
  if (!arrived(point.x, point.y))
    return;
  ++leg_;
  enter(leg_ < route_.size() ? MissionState::GOTO : MissionState::ALIGN);
}

void MissionNode::runAlign() {
  flyTo(hold_x_, hold_y_, takeoff_height_, search_yaw_);
  const double error = wrapAngle(search_yaw_ - flight_.yaw);
  if (std::fabs(error) < yaw_tolerance_) {
    enter(MissionState::SEARCH);
    search_.resume(flight_.yaw, now_);
  }
}

void MissionNode::runSearch() {
  turnInPlace(search_.yawRate());
  if (search_.exhausted()) {
    ROS_WARN("nobody was found");
    enter(MissionState::RETURN);
  }
}

void MissionNode::runTrack() {
  if (tracker_.lost(now_)) {
    tracker_.reset();
    person_x_.reset();
    person_y_.reset();
    enter(MissionState::SEARCH);
    search_.resume(flight_.yaw, now_);
    return runSearch();
  }
  if (!tracker_.identified()) {
    centreFace();
    return;
  }
  if (in_range_ && centred_ && pictures_.mayCapture(now_)) {
    centreFace();
    takePicture();
  } else if (enable_approach_)
    approachFace();
  else
    centreFace();
}

void MissionNode::takePicture() {
  CapturePicture capture;
  capture.request.coverage = tracker_.coverage();
  int attempts = 0;
  bool taken = false;
  do {
    taken = capture_client_.call(capture) && capture.response.accepted;
    ++attempts;
  } while (!taken && pictures_.mayRetry(attempts));
  if (!taken)
    return;
  pictures_.noteCapture(now_);
  ROS_INFO("picture %u", capture.response.picture_id);
  if (pictures_.albumFull())
    enter(MissionState::RETURN);
}

void MissionNode::runReturn() {
  flyTo(landing_x_, landing_y_, takeoff_height_, goal_yaw_);
  if (arrived(landing_x_, landing_y_))
    enter(MissionState::LAND);
  else if (legOverdue())
    enter(MissionState::ABORT);
}

void MissionNode::runLand() {
  descend();
  if (touchedDown()) {
    sendWayPose(WayPose());
    enter(MissionState::DONE);
  }
}

void MissionNode::runAbort() {
  descend();
  if (touchedDown()) {
    sendWayPose(WayPose());
    enter(MissionState::DONE);
  }
}

bool MissionNode::arrived(double x, double y) const {
  const double dx = x - flight_.position.x;
  const double dy = y - flight_.position.y;
  return dx * dx + dy * dy < waypoint_tolerance_ * waypoint_tolerance_;
}

bool MissionNode::legOverdue() const {
  return (now_ - entered_).toSec() > leg_timeout_;
}

bool MissionNode::touchedDown() const {
  return flight_.position.z < min_land_height_;
}

} // namespace image_capture
