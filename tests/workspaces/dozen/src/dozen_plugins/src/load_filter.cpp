// Loads the plugin and the nodelet by their names and prints how many of eight values
// the plugin lets through.
#include <class_loader/class_loader.hpp>
#include <dozen_plugins/filter.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_loader.hpp>
#include <ros/ros.h>

#include <cstdio>

int main(int argc, char **argv) {
  ros::init(argc, argv, "load_filter");
  ros::NodeHandle handle;
  pluginlib::ClassLoader<dozen_plugins::Filter> loader("dozen_plugins", "dozen_plugins::Filter");
  auto filter = loader.createUniqueInstance("dozen_plugins/HighPass");
  filter->start(handle);
  class_loader::ClassLoader nodelets("libdozen_nodelet.so");
  if (!nodelets.createUniqueInstance<nodelet::Nodelet>("dozen_plugins::Relay"))
    return 1;
  int passed = 0;
  for (int i = 0; i < 8; ++i)
    passed += filter->offer(i);
  std::printf("%d passed\n", passed);
}
