// Thresholds in a pair, a tuple, an optional, and structured bindings.
#include <optional>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <tuple>
#include <utility>

namespace {

std::pair<double, double> readWindow(const ros::NodeHandle &nh) {
  double low, high;
  nh.param("low", low, -6.0);
  nh.param("high", high, 6.0);
  return {low, high};
}

std::tuple<int, double, bool> readRest(const ros::NodeHandle &nh) {
  return std::make_tuple(nh.param("skip", 2), nh.param("step", 1.0),
                         nh.param("strict", true));
}

std::optional<double> readNotch(const ros::NodeHandle &nh) {
  double notch = 0.0;
  if (nh.getParam("notch", notch) || nh.getParam("default_notch", notch))
    return notch;
  return 0.25;
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_pair_tuple_optional");
  ros::NodeHandle nh;
  const std::pair<double, double> window = readWindow(nh);
  const auto rest = readRest(nh);
  const auto [skip, step, strict] = rest;
  const std::optional<double> notch = readNotch(nh);
  const int first = skip;

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  double last = 0.0;
  int seen = 0;
  auto callback = [&, is_strict = strict](const std_msgs::Float64ConstPtr &m) {
    if (seen++ < first)
      return;
    if (m->data < window.first || m->data > window.second)
      return;
    if (std::fabs(m->data) < *notch)
      return;
    const double change = std::fabs(m->data - last);
    if (is_strict && change < std::get<1>(rest))
      return;
    last = m->data;
    pub.publish(m);
  };
  ros::Subscriber sub =
      nh.subscribe<std_msgs::Float64>("input", 1000, callback);
  (void)step;
  ros::spin();
}
