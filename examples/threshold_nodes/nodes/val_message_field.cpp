// Thresholds kept in fields of a message, which is also published, and in a
// struct that holds the message.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

struct Setup {
  std_msgs::Float64 limit;
  std_msgs::Float64 reference;
  int divider;
};

static Setup setup;
static ros::Publisher limit_pub, array_pub;

static void onInput(const std_msgs::Float64 &msg) {
  static std_msgs::Float64MultiArray batch;
  static int skipped = 0;
  if (msg.data > setup.limit.data) {
    limit_pub.publish(setup.limit);
    return;
  }
  if (msg.data < setup.reference.data)
    ROS_DEBUG("%d values are too low", ++skipped);
  batch.data.push_back(msg.data);
  if (static_cast<int>(batch.data.size()) == setup.divider) {
    array_pub.publish(batch);
    batch.data.clear();
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_message_field");
  ros::NodeHandle nh;
  nh.param("limit", setup.limit.data, 6.0);
  setup.reference.data = nh.param("reference", -6.0);
  setup.divider = 3;
  nh.getParam("batch_size", setup.divider);
  limit_pub = nh.advertise<std_msgs::Float64>("limit_output", 1000);
  array_pub = nh.advertise<std_msgs::Float64MultiArray>("batches", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, onInput);
  ros::spin();
}
