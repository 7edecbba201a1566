// A manager with two nodelets that report, 100 times a second each, and read
// parameters: what runs in one process has one sink and one service.

#include <nodelet/loader.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <tpc/LogOne.h>

#include <string>

namespace {

class Reporting : public nodelet::Nodelet {
  void onInit() override {
    Key = getName() == "/first" ? "00000001" : "00000002";
    Key += "-0000-4000-8000-000000000000";
    // As instrumented code does before it reads the parameter.
    const std::string Limit = "limit";
    log_read(const_cast<char *>(Key.c_str()), &getPrivateNodeHandle(), &Limit,
             false);
    log_read(const_cast<char *>(Key.c_str()), nullptr, "~shared", true);
    log_read(const_cast<char *>(Key.c_str()), &getPrivateNodeHandle(),
             "not a name", true);
    Timer = getNodeHandle().createWallTimer(
        ros::WallDuration(0.01), [this](const ros::WallTimerEvent &) {
          log_one(const_cast<char *>(Key.c_str()), true, ++Count, 0.5, true);
        });
  }

  std::string Key;
  double Count = 0;
  ros::WallTimer Timer;
};

} // namespace

int main(int Count, char **Words) {
  ros::init(Count, Words, "manager");
  const boost::function<boost::shared_ptr<nodelet::Nodelet>(
      const std::string &)>
      Make =
          [](const std::string &) { return boost::make_shared<Reporting>(); };
  nodelet::Loader Loader(Make);
  for (const char *Name : {"/first", "/second"})
    if (!Loader.load(Name, "sinks/Reporting", {}, {}))
      return 1;
  ros::spin();
  return 0;
}
