#include <dozen_tested/doubler.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "doubler_node");
  ros::NodeHandle handle;
  Doubler doubler(100);
  doubler.connect(handle);
  for (int i = 1; i < 8; ++i)
    doubler.offer(i);
  ros::spin();
}
