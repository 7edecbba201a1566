#include "navigator.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace heavy {

Localiser::Localiser(const ros::NodeHandle &handle, LayeredGrid &grid,
                     tf2_ros::TransformBroadcaster &out)
    : grid_(grid), out_(out) {
  ros::NodeHandle own(handle, "localiser");
  own.param("alpha1", alpha1_, 0.2);
  own.param("alpha2", alpha2_, 0.2);
  own.param("hit", hit_, 0.95);
  own.param("noise", noise_, 0.05);
  own.param("range", range_, 2.0);
  own.param("update_d", updateD_, 0.2);
  double degrees;
  own.param("update_a", degrees, 30.0);
  updateA_ = degrees * M_PI / 180;
  own.param("recover", recover_, 0.1);
  own.param("most", most_, 2000);
  own.param("least", least_, 100);
  own.param("every", every_, 2);
  own.param("model", model_, std::string("field"));
  if (least_ > most_) {
    ROS_WARN("least is larger than most");
    std::swap(least_, most_);
  }
  particles_.assign(most_, Particle{0, 0, 0, 1.0 / most_});
  cloud_ = own.advertise<geometry_msgs::PoseArray>("cloud", 2);
  mean_ = own.advertise<geometry_msgs::PoseStamped>("pose", 2);
}

void Localiser::onOdometry(const nav_msgs::Odometry &odometry) {
  if (started_) {
    double dx = odometry.pose.pose.position.x - last_.pose.pose.position.x;
    double dy = odometry.pose.pose.position.y - last_.pose.pose.position.y;
    double turn = 2 * (std::asin(odometry.pose.pose.orientation.z) -
                       std::asin(last_.pose.pose.orientation.z));
    predict(std::hypot(dx, dy), turn);
  }
  last_ = odometry;
  started_ = true;
}

void Localiser::predict(double forward, double turn) {
  std::normal_distribution<double> along(
      0, std::sqrt(alpha1_ * forward * forward + alpha2_ * turn * turn) + 1e-9);
  for (Particle &p : particles_) {
    double moved = forward + along(random_);
    p.x += moved * std::cos(p.yaw);
    p.y += moved * std::sin(p.yaw);
    p.yaw += turn + along(random_);
    if (p.yaw > M_PI)
      p.yaw -= 2 * M_PI;
  }
  moved_ += forward;
  turned_ += std::fabs(turn);
}

double Localiser::fit(const Particle &p,
                      const sensor_msgs::LaserScan &scan) const {
  double total = 0;
  size_t step = std::max<size_t>(1, scan.ranges.size() / 30);
  for (size_t i = 0; i < scan.ranges.size(); i += step) {
    double range = scan.ranges[i],
           angle = p.yaw + scan.angle_min + i * scan.angle_increment;
    if (!(range < range_))
      continue;
    Cell cell;
    if (!grid_.grid().toCell(p.x + range * std::cos(angle),
                             p.y + range * std::sin(angle), cell))
      continue;
    double off = (254 - grid_.grid().cost(cell.x, cell.y)) / 254.0;
    total += model_ == "beam"
                 ? hit_ * (off < noise_)
                 : hit_ * std::exp(-off * off / (2 * noise_ * noise_));
  }
  return total;
}

double Localiser::spread() const {
  double x = 0, y = 0, all = 0;
  for (const Particle &p : particles_) {
    x += p.x * p.weight;
    y += p.y * p.weight;
  }
  for (const Particle &p : particles_)
    all += p.weight * std::hypot(p.x - x, p.y - y);
  return all;
}

void Localiser::resample() {
  std::vector<double> weights;
  std::transform(particles_.begin(), particles_.end(),
                 std::back_inserter(weights),
                 [](const Particle &p) { return p.weight; });
  std::discrete_distribution<size_t> draw(weights.begin(), weights.end());
  std::vector<Particle> drawn;
  std::set<std::pair<int, int>> bins;
  std::uniform_real_distribution<double> chance(0, 1);
  while (drawn.size() < static_cast<size_t>(most_)) {
    Particle p = particles_[draw(random_)];
    if (chance(random_) < recover_ && spread() > range_) {
      p.x += chance(random_);
      p.y += chance(random_);
    }
    drawn.push_back(p);
    bins.insert({int(p.x * 2), int(p.y * 2)});
    if (drawn.size() >= static_cast<size_t>(least_) &&
        drawn.size() > 30 * bins.size())
      break;
  }
  for (Particle &p : drawn)
    p.weight = 1.0 / drawn.size();
  particles_.swap(drawn);
}

void Localiser::onScan(const sensor_msgs::LaserScanConstPtr &scan) {
  if (moved_ < updateD_ && turned_ < updateA_)
    return;
  moved_ = turned_ = 0;
  for (Particle &p : particles_)
    p.weight *= fit(p, *scan);
  double sum =
      std::accumulate(particles_.begin(), particles_.end(), 0.0,
                      [](double s, const Particle &p) { return s + p.weight; });
  for (Particle &p : particles_)
    p.weight = sum > 0 ? p.weight / sum : 1.0 / particles_.size();
  if (++count_ % every_ == 0)
    resample();
  geometry_msgs::PoseArray cloud;
  for (const Particle &p : particles_) {
    geometry_msgs::Pose pose;
    pose.position.x = p.x;
    pose.position.y = p.y;
    pose.orientation.z = std::sin(p.yaw / 2);
    pose.orientation.w = std::cos(p.yaw / 2);
    cloud.poses.push_back(pose);
  }
  cloud_.publish(cloud);
  auto best = std::max_element(
      particles_.begin(), particles_.end(),
      [](const Particle &a, const Particle &b) { return a.weight < b.weight; });
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = scan->header.stamp;
  transform.header.frame_id = "map";
  transform.child_frame_id = "odom";
  transform.transform.translation.x = best->x - last_.pose.pose.position.x;
  transform.transform.translation.y = best->y - last_.pose.pose.position.y;
  transform.transform.rotation.w = 1;
  out_.sendTransform(transform);
  geometry_msgs::PoseStamped mean;
  mean.pose = cloud.poses[best - particles_.begin()];
  mean_.publish(mean);
}

} // namespace heavy
