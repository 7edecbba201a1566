// A singleton holds the settings; the comparison asks it each time.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>

class Settings {
public:
  static Settings &instance() {
    static Settings settings;
    return settings;
  }

  void load(const ros::NodeHandle &nh) {
    nh.param("alarm_level", alarm_level_, 6.0);
    nh.param("silent", silent_, false);
    nh.param("history", history_, 5);
  }

  double alarmLevel() const { return alarm_level_; }
  bool silent() const { return silent_; }
  int history() const { return history_; }

  Settings(const Settings &) = delete;
  Settings &operator=(const Settings &) = delete;

private:
  Settings() = default;
  double alarm_level_ = 0.0;
  bool silent_ = true;
  int history_ = 0;
};

static ros::Publisher alarm_pub;
static int alarms_kept = 0;

static void callback(const std_msgs::Float64::ConstPtr &msg) {
  const Settings &settings = Settings::instance();
  if (alarms_kept > settings.history())
    alarms_kept = 0;
  if (msg->data > settings.alarmLevel()) {
    ++alarms_kept;
    if (!Settings::instance().silent())
      alarm_pub.publish(msg);
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_singleton");
  ros::NodeHandle nh;
  Settings::instance().load(nh);
  alarm_pub = nh.advertise<std_msgs::Float64>("alarm", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, callback);
  ros::spin();
  return 0;
}
