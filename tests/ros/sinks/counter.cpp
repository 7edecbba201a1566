// A subscriber as users write it: it counts the reports that it gets on
// /rosout and /threshold_information, with a queue of 100 messages, and says
// the number at its end: `got N`.

#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <cstdio>

static long Got = 0;

static void takeLog(const rosgraph_msgs::Log::ConstPtr &Message) {
  Got += Message->msg.compare(0, 22, "threshold_information:") == 0;
}

/// Reports are all lines but the first, which begins with a number sign.
static void takeBatch(const std_msgs::String::ConstPtr &Message) {
  Got += std::count(Message->data.begin(), Message->data.end(), '\n');
}

int main(int Count, char **Words) {
  ros::init(Count, Words, "counter");
  ros::NodeHandle Node;
  const ros::Subscriber Logs = Node.subscribe("/rosout", 100, takeLog);
  const ros::Subscriber Batches =
      Node.subscribe("/threshold_information", 100, takeBatch);
  ros::spin();
  std::printf("got %ld\n", Got);
  return 0;
}
