// The publish stands two calls behind the threshold, free functions.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int64.h>

static ros::Publisher ticket_pub;
static std::int64_t tickets;
static double ticket_limit = 5.0;

static void publishTicket() {
  std_msgs::Int64 ticket;
  ticket.data = tickets;
  ticket_pub.publish(ticket);
}

static void openTicket() {
  ++tickets;
  publishTicket();
}

static void inputCallback(const std_msgs::Float64 &msg) {
  if (msg.data >= ticket_limit)
    openTicket();
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_two_calls");
  ros::NodeHandle nh;
  nh.getParam("ticket_limit", ticket_limit);
  ticket_pub = nh.advertise<std_msgs::Int64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
}
