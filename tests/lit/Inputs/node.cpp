// A node with a number, a count and a flag that decide whether it publishes.
#include <ros/ros.h>

#include <cstdlib>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("limit", Limit, 2.5);
    Handle.param("most", Most, 3);
    Handle.param("quiet", Quiet, false);
    Out = Handle.advertise<std_msgs::Number>("out", 1);
  }
  void step(double Value) {
    std_msgs::Number Message;
    Message.data = Value;
    bool Enough = Value > Limit;
    if (Quiet)
      return;
    if (Enough && Count < Most) {
      ++Count;
      Out.publish(Message);
    }
  }

private:
  ros::Publisher Out;
  double Limit;
  int Most, Count = 0;
  bool Quiet;
};

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  for (int I = 0; I < 7; ++I)
    N.step(I);
}
