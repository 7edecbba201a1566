// Negative twin of exp_three_calls: the calls behind the threshold end in a
// log line and a statistic.
#include <iostream>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Journal {
public:
  void note(double angle) { write("moved", angle); }

private:
  void write(const char *what, double angle) {
    ++lines_;
    std::cout << lines_ << ": " << what << " to " << angle << "\n";
  }

  int lines_ = 0;
};

class Planner {
public:
  explicit Planner(ros::NodeHandle &nh)
      : pub_(nh.advertise<std_msgs::Float64>("output", 1000)) {
    nh.param("planner/reach", reach_, 3.5);
    sub_ = nh.subscribe("input", 1000, &Planner::plan, this);
  }

private:
  void plan(const std_msgs::Float64::ConstPtr &goal) {
    if (goal->data <= reach_)
      journal_.note(goal->data);
    pub_.publish(goal);
  }

  Journal journal_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double reach_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_calls_without_publish");
  ros::NodeHandle nh;
  Planner planner(nh);
  ros::spin();
  return 0;
}
