// Parameters that are lists and structs: XmlRpcValue and vectors.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>
#include <stdexcept>
#include <string>
#include <vector>
#include <xmlrpcpp/XmlRpcValue.h>

static double numberOf(XmlRpc::XmlRpcValue &value) {
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt)
    return static_cast<int>(value);
  return static_cast<double>(value);
}

class Zones {
public:
  explicit Zones(ros::NodeHandle &nh) : pnh_("~") {
    XmlRpc::XmlRpcValue edges;
    if (!pnh_.getParam("edges", edges)) {
      edges[0] = -3.0;
      edges[1] = 5;
    }
    if (edges.size() > 1)
      low_ = static_cast<double>(edges[0]);
    high_ = numberOf(edges[1]);

    XmlRpc::XmlRpcValue zone;
    if (!pnh_.getParam("zone", zone)) {
      zone["width"] = 2.0;
      zone["name"] = "wide";
    }
    width_ = zone["width"];
    name_ = static_cast<std::string>(zone["name"]);

    XmlRpc::XmlRpcValue rows;
    if (!pnh_.getParam("rows", rows))
      rows[0][0] = 4.0;
    for (int i = 0; i < rows.size(); ++i) {
      XmlRpc::XmlRpcValue row = rows[i];
      row_ = static_cast<double>(row[0]);
    }

    XmlRpc::XmlRpcValue shown;
    if (!pnh_.getParam("shown", shown))
      shown[0] = 1.0;
    shown_ = static_cast<double>(shown[0]);

    pnh_.getParam("weights", weights_);
    weights_.resize(3, 0.5);
    pnh_.getParam("labels", labels_);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    label_pub_ = nh.advertise<std_msgs::String>("label", 1000);
    sub_ = nh.subscribe("input", 1000, &Zones::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (msg->data < low_)
      return;
    if (msg->data > high_)
      return;
    if (msg->data > shown_)
      ROS_INFO("beyond what is shown");
    std_msgs::String label;
    if (msg->data > width_)
      label.data = "out";
    if (name_ == "wide")
      label.data += " wide";
    for (const std::string &each : labels_)
      if (each == "loud")
        label.data += "!";
    label_pub_.publish(label);
    if (msg->data < row_)
      return;
    XmlRpc::XmlRpcValue fixed;
    fixed[0] = 6.0;
    if (msg->data > static_cast<double>(fixed[0]))
      return;
    if (msg->data > weights_[1])
      pub_.publish(msg);
  }

  ros::NodeHandle pnh_;
  double low_ = -10, high_, width_, row_ = -10, shown_;
  std::string name_;
  std::vector<double> weights_;
  std::vector<std::string> labels_;
  ros::Publisher pub_, label_pub_;
  ros::Subscriber sub_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_lists");
  ros::NodeHandle nh;
  Zones zones(nh);
  ros::spin();
  return 0;
}
