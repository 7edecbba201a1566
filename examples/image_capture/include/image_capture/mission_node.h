// The mission: take off, fly to a point, turn until a face is seen, centre it,
// take the picture, fly home, land.
#ifndef IMAGE_CAPTURE_MISSION_NODE_H
#define IMAGE_CAPTURE_MISSION_NODE_H

#include <array>
#include <cstddef>
#include <cstdint>

#include <image_capture/FaceArray.h>
#include <image_capture/FlightState.h>
#include <image_capture/MissionState.h>
#include <image_capture/WayPose.h>
#include <ros/ros.h>

#include "image_capture/face_tracker.h"
#include "image_capture/filters.h"
#include "image_capture/heartbeat_publisher.h"
#include "image_capture/picture_logic.h"
#include "image_capture/search_pattern.h"

namespace image_capture {

class MissionNode {
public:
  MissionNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh);

private:
  void readParameters(ros::NodeHandle &private_nh);
  void onFlightState(const FlightState &state);
  void onFaces(const FaceArray &image);
  void onTick(const ros::TimerEvent &event);
  void onStatus(const ros::TimerEvent &event);

  // One for each state; called ten times a second.
  void runState();
  void runIdle();
  void runTakeoff();
  void runGoto();
  void runAlign();
  void runSearch();
  void runTrack();
  void runReturn();
  void runLand();
  void runAbort();

  void enter(std::uint8_t state);
  void watchTime();
  void watchLatency(const FaceArray &image);
  void assessFace();
  void takePicture();
  bool arrived(double x, double y) const;
  bool legOverdue() const;
  bool touchedDown() const;

  void flyTo(double x, double y, double z, double yaw);
  void turnInPlace(double yaw_rate);
  void centreFace();
  void approachFace();
  void descend();
  void sendWayPose(const WayPose &waypose);
  void publishState();
  void publishAlbum();

  SearchPattern search_;
  FaceTracker tracker_;
  PictureLogic pictures_;
  HeartbeatPublisher heartbeat_;

  ros::Publisher waypose_pub_;
  ros::Publisher state_pub_;
  ros::Publisher album_pub_;
  ros::Publisher detector_pub_;
  ros::Publisher done_pub_;
  ros::Subscriber flight_sub_;
  ros::Subscriber faces_sub_;
  ros::ServiceClient capture_client_;
  ros::Timer tick_timer_;
  ros::Timer status_timer_;

  /// The points that it flies along from the start: a gate, then the point of the search.
  struct Point {
    double x = 0.0;
    double y = 0.0;
  };
  std::array<Point, 2> route_;
  std::size_t leg_ = 0;
  double search_yaw_;
  double landing_x_, landing_y_;
  double takeoff_height_;
  double waypoint_tolerance_;
  double yaw_tolerance_;
  double min_land_height_;
  double start_delay_;
  double leg_timeout_;
  double mission_timeout_;
  double selfie_control_rate_;
  double late_image_age_;
  double camera_half_angle_;
  double face_area_;
  bool enable_approach_;

  std::uint8_t state_ = MissionState::IDLE;
  ros::Time now_;
  ros::Time entered_;
  ros::Time started_;
  FlightState flight_;
  double frame_rate_ = 0.0;
  unsigned late_images_ = 0;
  bool centred_ = false;
  bool in_range_ = false;
  double hold_x_ = 0.0, hold_y_ = 0.0;
  double goal_yaw_ = 0.0;
  IirLowPass person_x_{0.2}, person_y_{0.2};
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_MISSION_NODE_H
