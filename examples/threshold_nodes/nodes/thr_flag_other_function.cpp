// A flag that one member function sets, by a threshold, is used in another one,
// which a timer calls; the queue between them keeps the order.
#include <deque>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

class CollisionMonitor {
public:
  explicit CollisionMonitor(ros::NodeHandle nh) : m_nh(nh) {
    m_nh.param<double>("collision/stop_distance", m_stop_distance, -2.0);
    m_nh.param<bool>("collision/report_clear", m_report_clear, false);
    m_pub = m_nh.advertise<std_msgs::Bool>("output", 1000);
    m_sub = m_nh.subscribe("input", 1000, &CollisionMonitor::scanCb, this);
    m_timer = m_nh.createWallTimer(ros::WallDuration(0.01),
                                   &CollisionMonitor::timerCb, this);
  }

private:
  struct Scan {
    double distance = 0.0;
    bool danger = false;
  };

  void scanCb(const std_msgs::Float64 &msg) {
    Scan scan;
    scan.distance = msg.data;
    evaluate(scan);
    m_scans.push_back(scan);
  }

  void evaluate(Scan &scan) const {
    if (scan.distance < m_stop_distance)
      scan.danger = true;
  }

  void timerCb(const ros::WallTimerEvent &) {
    while (!m_scans.empty()) {
      const Scan scan = m_scans.front();
      m_scans.pop_front();
      if (scan.danger || m_report_clear) {
        std_msgs::Bool stop;
        stop.data = scan.danger;
        m_pub.publish(stop);
      }
    }
  }

  ros::NodeHandle m_nh;
  ros::Publisher m_pub;
  ros::Subscriber m_sub;
  ros::WallTimer m_timer;
  std::deque<Scan> m_scans;
  double m_stop_distance;
  bool m_report_clear;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_flag_other_function");
  CollisionMonitor monitor{ros::NodeHandle()};
  ros::spin();
  return 0;
}
