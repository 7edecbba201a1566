//===- RosControl.cpp -----------------------------------------------------===//
#include "ros1/RosControl.h"
#include "Runtime.h"
#include "ros1/RosLife.h"

#include <ros/advertise_service_options.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/param.h>
#include <ros/service_manager.h>
#include <ros/this_node.h>
#include <ros/time.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <iterator>
#include <vector>

namespace tpc {

static constexpr int64_t Ms = 1'000'000;
static constexpr int64_t SoonNs = 20 * Ms;
static constexpr int64_t LateNs = 250 * Ms;
/// For this many polls, checks often whether roscpp has started; after that
/// seldom.
static constexpr int SoonPolls = 500;
static constexpr std::chrono::seconds FirstRetry{1}, LastRetry{60};
static const char *const Service = "~tpc/reload";

namespace {

/// The settings of this process in ROS. Its members are used by the thread that
/// asks the master, unless they are atomic.
class Control {
public:
  static Control &instance() {
    // Never destroyed: threads may use it until the very end.
    static Control &Only = *new Control;
    return Only;
  }

  int64_t poll();

private:
  using Clock = std::chrono::steady_clock;
  using Texts = std::vector<std::string>;

  void begin();
  void serve() { Queue.callAvailable(); }
  bool reload(std_srvs::Trigger::Request &,
              std_srvs::Trigger::Response &Answer);
  Texts takeParameters();
  void warnOfNew(const Texts &Complaints);
  void takeFrom(const char *Place, Config &New, const Config &Now,
                Texts &Complaints);

  Texts Told; ///< at the last time
  WakingQueue Queue;
  const Config OfEnvironment = current();
  std::atomic<bool> Served{false};
  std::atomic<bool> Failed{false};
  std::atomic<Clock::rep> RetryAt{0};
  std::chrono::seconds Retry = FirstRetry;
  int Polls = 0; // by the helper thread
};

} // namespace

/// Converts a value of the parameter server to the text of a variable of the
/// environment. YAML reads `off` as false.
static bool textOf(const std::string &Name, XmlRpc::XmlRpcValue &Value,
                   std::string &Text) {
  switch (Value.getType()) {
  case XmlRpc::XmlRpcValue::TypeString:
    Text = static_cast<std::string &>(Value);
    return true;
  case XmlRpc::XmlRpcValue::TypeInt:
    Text = std::to_string(static_cast<int &>(Value));
    return true;
  case XmlRpc::XmlRpcValue::TypeDouble: {
    char Buffer[32];
    Text.assign(Buffer, std::to_chars(Buffer, std::end(Buffer),
                                      static_cast<double &>(Value))
                            .ptr);
    return true;
  }
  case XmlRpc::XmlRpcValue::TypeBoolean:
    if (Name != "sink" || static_cast<bool &>(Value))
      return false;
    Text = "off";
    return true;
  default:
    return false;
  }
}

/// Sets the setting \p Name in \p New back to its value in \p Now.
static void keep(Config &New, const Config &Now, const std::string &Name) {
  if (Name == "sink")
    New.Sink = Now.Sink;
  else if (Name == "policy")
    New.Policy = Now.Policy;
  else if (Name == "period")
    New.PeriodNs = Now.PeriodNs;
  else if (Name == "site_cap")
    New.SiteCap = Now.SiteCap;
  else if (Name == "process_cap")
    New.ProcessCap = Now.ProcessCap;
}

void Control::takeFrom(const char *Place, Config &New, const Config &Now,
                       Texts &Complaints) {
  const std::string Folder = ros::names::resolve(Place);
  XmlRpc::XmlRpcValue Found;
  if (!ros::param::get(Folder, Found))
    return;
  if (Found.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    Complaints.push_back("the parameter " + Folder +
                         " is not a namespace of parameters and is ignored");
    return;
  }
  for (auto &[Name, Value] : Found) {
    const std::string Parameter = Folder + "/" + Name;
    const auto *Known =
        std::find(std::begin(ConfigNames), std::end(ConfigNames), Name);
    if (Known == std::end(ConfigNames)) {
      Complaints.push_back("there is no setting " + Name + " (" + Parameter +
                           ")");
      continue;
    }
    if (Known >= ConfigNames + ParameterNames) {
      Complaints.push_back("the parameter " + Parameter +
                           " is ignored: only the environment of the node "
                           "sets it (" +
                           variableOf(Name) + ")");
      continue;
    }
    std::string Text, Why = "it is of the wrong type";
    if (textOf(Name, Value, Text) && parse(New, Name, Text, Why))
      continue;
    keep(New, Now, Name);
    Complaints.push_back("the parameter " + Parameter + " is ignored: " + Why);
  }
}

Control::Texts Control::takeParameters() {
  Texts Complaints;
  // Asked first, because the calls below cannot distinguish a parameter that is
  // not set from a master that does not answer.
  if (!ros::master::check()) {
    Complaints.push_back("the ROS master does not answer; the settings "
                         "stay as they are");
    return Complaints;
  }
  const Config Now = current();
  Config New = OfEnvironment;
  takeFrom("/tpc", New, Now, Complaints);
  takeFrom("~tpc", New, Now, Complaints);
  if (!(New == Now) && !apply(New))
    Complaints.push_back(
        "the settings cannot be applied; the previous ones stay");
  return Complaints;
}

/// Who calls the service again and again does not fill the node's output.
void Control::warnOfNew(const Texts &Complaints) {
  for (const std::string &Complaint : Complaints)
    if (std::find(Told.begin(), Told.end(), Complaint) == Told.end())
      warn(Complaint);
  Told = Complaints;
}

bool Control::reload(std_srvs::Trigger::Request &,
                     std_srvs::Trigger::Response &Answer) {
  const Texts Complaints = takeParameters();
  warnOfNew(Complaints);
  for (const std::string &Complaint : Complaints)
    Answer.message += Complaint + "; ";
  Answer.success = Complaints.empty();
  Answer.message += statusLine();
  return true;
}

void Control::begin() {
  if (!ros::master::check()) {
    if (!Failed)
      warn("the ROS master does not answer yet: its parameters are not read, "
           "and " +
           ros::names::resolve(Service) + " is not advertised");
    RetryAt = (Clock::now() + Retry).time_since_epoch().count();
    Retry = std::min(2 * Retry, LastRetry);
    Failed = true;
    return;
  }
  Failed = false;
  Retry = FirstRetry;
  warnOfNew(takeParameters());
  ros::AdvertiseServiceOptions Options;
  Options.init<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
      ros::names::resolve(Service),
      [this](auto &Request, auto &Answer) { return reload(Request, Answer); });
  Options.callback_queue = &Queue;
  // roscpp itself logs a failure, and another try would fail too.
  ros::ServiceManager::instance()->advertiseService(Options);
  Served = true;
}

int64_t Control::poll() {
  RosUse Use;
  if (!Use)
    return -1;
  if (!rosIsUp()) {
    // A node that was shut down may start again, and then has no services.
    Served = false;
    return Polls < SoonPolls ? (++Polls, SoonNs) : LateNs;
  }
  if (!Served) {
    if (Failed && Clock::now().time_since_epoch().count() < RetryAt)
      return LateNs;
    // The thread wakes the helper when it is done.
    askMaster([this] {
      if (!Served)
        begin();
    });
    return SoonNs;
  }
  if (Queue.isEmpty())
    return -1;
  askMaster([this] { serve(); });
  return SoonNs;
}

int64_t pollRos() {
  try {
    return Control::instance().poll();
  } catch (...) {
    return LateNs;
  }
}

void rosEnd() { endRosUse(); }

const char *rosNodeName() {
  if (!ros::isInitialized())
    return "";
  static const std::string &Name = *new std::string(ros::this_node::getName());
  return Name.c_str();
}

/// Whether ros::Time is initialised. Until then it claims to be simulated.
static bool timeIsKnown() {
  static std::atomic<bool> Known{false};
  if (Known)
    return true;
  if (!ros::isStarted())
    return false;
  try {
    ros::Time::now();
    Known = true;
  } catch (const std::exception &) {
    return false;
  }
  return true;
}

bool rosTimeIsSimulated() { return timeIsKnown() && ros::Time::isSimTime(); }

int64_t rosNow() {
  // A forked child gets no /clock, and the lock of the time may stay locked.
  static std::atomic<int64_t> Last{0};
  if (!timeIsKnown())
    return 0;
  if (forkedFromNode() && ros::Time::isSimTime())
    return Last;
  const auto Now = static_cast<int64_t>(ros::Time::now().toNSec());
  Last.store(Now, std::memory_order_relaxed);
  return Now;
}

} // namespace tpc
