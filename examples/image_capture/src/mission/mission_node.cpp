#include "image_capture/mission_node.h"

#include <algorithm>
#include <cmath>

#include <image_capture/Album.h>
#include <image_capture/CapturePicture.h>
#include <std_msgs/Bool.h>

namespace image_capture {

namespace {
const char *const StateNames[] = {"idle",  "takeoff", "goto", "align", "search",
                                  "track", "return",  "land", "done",  "abort"};
} // namespace

MissionNode::MissionNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : search_(private_nh), tracker_(private_nh), pictures_(private_nh),
      heartbeat_(nh, private_nh) {
  readParameters(private_nh);
  waypose_pub_ = nh.advertise<WayPose>("/mission/waypose", 10);
  state_pub_ = nh.advertise<MissionState>("/mission/state", 10, true);
  album_pub_ = nh.advertise<Album>("/mission/album", 10, true);
  detector_pub_ = nh.advertise<std_msgs::Bool>("/camera/detect", 1, true);
  done_pub_ = nh.advertise<std_msgs::Bool>("/mission/done", 1, true);
  capture_client_ = nh.serviceClient<CapturePicture>("/camera/capture");
  flight_sub_ =
      nh.subscribe("/controller/state", 10, &MissionNode::onFlightState, this);
  faces_sub_ = nh.subscribe("/camera/faces", 10, &MissionNode::onFaces, this);
  tick_timer_ = nh.createTimer(ros::Duration(0.1), &MissionNode::onTick, this);
  status_timer_ =
      nh.createTimer(ros::Duration(1.0), &MissionNode::onStatus, this);
}

void MissionNode::readParameters(ros::NodeHandle &private_nh) {
  private_nh.param("gate_x", route_[0].x, 2.0);
  private_nh.param("gate_y", route_[0].y, -0.5);
  private_nh.param("search_x", route_[1].x, 4.0);
  private_nh.param("search_y", route_[1].y, 1.0);
  private_nh.param("search_yaw", search_yaw_, -1.8);
  private_nh.param("landing_x", landing_x_, -1.0);
  private_nh.param("landing_y", landing_y_, 0.0);
  private_nh.param("takeoff_height", takeoff_height_, 1.6);
  private_nh.param("waypoint_tolerance", waypoint_tolerance_, 0.25);
  private_nh.param("min_land_height", min_land_height_, 0.15);
  private_nh.param("start_delay", start_delay_, 2.0);
  private_nh.param("leg_timeout", leg_timeout_, 25.0);
  private_nh.param("mission_timeout", mission_timeout_, 75.0);
  private_nh.param("selfie_control_rate", selfie_control_rate_, 5.0);
  private_nh.param("late_image_age", late_image_age_, 0.5);
  private_nh.param("face_area", face_area_, 0.2475);
  private_nh.param("enable_approach", enable_approach_, true);

  double degrees = 8.0;
  private_nh.getParam("yaw_tolerance_deg", degrees);
  yaw_tolerance_ = degrees * M_PI / 180.0;
  double field_of_view = 60.0;
  private_nh.getParam("field_of_view_deg", field_of_view);
  camera_half_angle_ = 0.5 * field_of_view * M_PI / 180.0;
}

void MissionNode::onFlightState(const FlightState &state) {
  flight_ = state;
  if (state_ == MissionState::SEARCH)
    search_.advance(state.yaw);
  if (state.aborting && state_ != MissionState::ABORT &&
      state_ != MissionState::DONE)
    enter(MissionState::ABORT);
}

void MissionNode::onFaces(const FaceArray &image) {
  frame_rate_ = image.frame_rate;
  watchLatency(image);
  if (state_ != MissionState::SEARCH && state_ != MissionState::TRACK)
    return;
  const ros::Time now = image.header.stamp;
  if (state_ == MissionState::SEARCH && !search_.looking(now))
    return;
  if (!tracker_.update(image, now))
    return;
  if (state_ == MissionState::SEARCH)
    enter(MissionState::TRACK);
  assessFace();
}

void MissionNode::watchLatency(const FaceArray &image) {
  if ((now_ - image.header.stamp).toSec() > late_image_age_) {
    ++late_images_;
    ROS_WARN_THROTTLE(5.0, "%u images came late", late_images_);
  }
}

void MissionNode::assessFace() {
  in_range_ = pictures_.coverageInRange(tracker_.coverage());
  centred_ = pictures_.centred(tracker_.offsetX());
  goal_yaw_ = flight_.yaw - tracker_.offsetX() * camera_half_angle_;
  const double distance = std::sqrt(face_area_ / tracker_.coverage());
  person_x_.update(flight_.position.x + distance * std::cos(goal_yaw_));
  person_y_.update(flight_.position.y + distance * std::sin(goal_yaw_));
}

void MissionNode::onTick(const ros::TimerEvent &event) {
  now_ = event.current_real;
  watchTime();
  runState();
}

void MissionNode::onStatus(const ros::TimerEvent &) { publishState(); }

void MissionNode::enter(std::uint8_t state) {
  ROS_INFO("%s -> %s", StateNames[state_], StateNames[state]);
  state_ = state;
  entered_ = ros::Time::now();
  hold_x_ = flight_.position.x;
  hold_y_ = flight_.position.y;
  goal_yaw_ = flight_.yaw;
  publishState();
  publishAlbum();
  // Face detection costs power, and on the way faces would only distract.
  std_msgs::Bool detect;
  detect.data = state == MissionState::SEARCH || state == MissionState::TRACK;
  detector_pub_.publish(detect);
  if (state == MissionState::DONE) {
    std_msgs::Bool done;
    done.data = true;
    done_pub_.publish(done);
  }
}

void MissionNode::flyTo(double x, double y, double z, double yaw) {
  WayPose waypose;
  waypose.position.x = x;
  waypose.position.y = y;
  waypose.position.z = z;
  waypose.yaw = yaw;
  waypose.motors_on = true;
  sendWayPose(waypose);
}

void MissionNode::turnInPlace(double yaw_rate) {
  WayPose waypose;
  waypose.position.x = hold_x_;
  waypose.position.y = hold_y_;
  waypose.position.z = takeoff_height_;
  waypose.turn = true;
  waypose.yaw_rate = yaw_rate;
  waypose.motors_on = true;
  sendWayPose(waypose);
}

void MissionNode::centreFace() {
  flyTo(hold_x_, hold_y_, takeoff_height_, goal_yaw_);
}

void MissionNode::approachFace() {
  double wanted = 0.0;
  if (pictures_.needsMove(tracker_.coverage(), wanted)) {
    const double dx = person_x_.value() - flight_.position.x;
    const double dy = person_y_.value() - flight_.position.y;
    const double distance = std::max(std::hypot(dx, dy), 0.1);
    hold_x_ = person_x_.value() - wanted * dx / distance;
    hold_y_ = person_y_.value() - wanted * dy / distance;
  }
  centreFace();
}

void MissionNode::descend() {
  flyTo(hold_x_, hold_y_, flight_.position.z - 0.5, goal_yaw_);
}

void MissionNode::sendWayPose(const WayPose &waypose) {
  WayPose message = waypose;
  message.header.stamp = now_;
  waypose_pub_.publish(message);
}

void MissionNode::publishState() {
  MissionState message;
  message.header.stamp = now_;
  message.state = state_;
  message.name = StateNames[state_];
  message.sightings = tracker_.sightings();
  message.coverage = tracker_.coverage();
  message.offset_x = tracker_.offsetX();
  message.centred = centred_;
  message.in_range = in_range_;
  message.selfies = pictures_.selfies();
  state_pub_.publish(message);
}

void MissionNode::publishAlbum() {
  Album message;
  message.header.stamp = now_;
  message.slots = pictures_.album();
  album_pub_.publish(message);
}

} // namespace image_capture
