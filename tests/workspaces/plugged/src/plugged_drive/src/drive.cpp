#include <plugged_core/planner.h>
#include <pluginlib/class_loader.hpp>
#include <std_msgs/Float64.h>

namespace {
class Drive {
public:
  Drive() : handle_("~"), loader_("plugged_core", "plugged::Planner") {
    std::string name;
    handle_.param("planner", name, std::string("plugged_direct/Direct"));
    planner_ = loader_.createInstance(name);
    planner_->configure(handle_);
    publisher_ = handle_.advertise<std_msgs::Float64>("go", 1);
    subscriber_ = handle_.subscribe("distance", 1, &Drive::hear, this);
  }

private:
  void hear(const std_msgs::Float64::ConstPtr &message) {
    if (planner_->mayGo(message->data))
      publisher_.publish(message);
  }

  ros::NodeHandle handle_;
  pluginlib::ClassLoader<plugged::Planner> loader_;
  boost::shared_ptr<plugged::Planner> planner_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};
} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "drive");
  Drive drive;
  ros::spin();
}
