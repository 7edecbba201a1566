// dynamic_reconfigure: fields compared in the callback and copied to members.
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <threshold_nodes/StepLimitConfig.h>

class StepLimiter {
public:
  StepLimiter() {
    server_.setCallback([this](threshold_nodes::StepLimitConfig &config,
                               uint32_t level) { reconfigure(config, level); });
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &StepLimiter::onInput, this);
  }

private:
  void reconfigure(threshold_nodes::StepLimitConfig &config, uint32_t) {
    if (config.lower > config.upper)
      config.lower = config.upper;
    m_lower = config.lower;
    m_upper = config.upper;
    m_enabled = config.enabled;
    double step = 100.0;
    if (config.max_step > 0)
      step = 1.0;
    m_step = step;
    ROS_INFO("step limits [%g, %g], gain %g", m_lower, m_upper, config.gain);
  }

  void onInput(const std_msgs::Float64ConstPtr &msg) {
    std_msgs::Float64 out;
    out.data = msg->data;
    if (m_enabled) {
      if (out.data > m_upper)
        out.data = m_upper;
      if (out.data < m_lower)
        out.data = m_lower;
    }
    out.data *= m_step;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  dynamic_reconfigure::Server<threshold_nodes::StepLimitConfig> server_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double m_lower = 0.0;
  double m_upper = 0.0;
  double m_step = 1.0;
  bool m_enabled = false;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_reconfigure_fields");
  StepLimiter limiter;
  ros::spin();
  return 0;
}
