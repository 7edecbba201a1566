#include <dozen_libs/counter.h>
#include <dozen_libs/gate.h>
#include <dozen_msgs/Level.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "user_node");
  ros::NodeHandle handle;
  Counter counter(handle);
  Gate gate(handle);
  double floor = 0;
  handle.getParam("floor", floor);
  ros::Publisher publisher = handle.advertise<dozen_msgs::Level>("level", 1);
  for (int i = 0; i < 8; ++i) {
    counter.count();
    gate.offer(i);
    dozen_msgs::Level message;
    message.level = i;
    if (message.level >= floor) // TPC floor
      publisher.publish(message);
  }
}
