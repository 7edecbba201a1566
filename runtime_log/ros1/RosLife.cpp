//===- RosLife.cpp --------------------------------------------------------===//
#include "ros1/RosLife.h"
#include "Modes.h"
#include "Runtime.h"

#include <ros/init.h>
#include <ros/names.h>
#include <ros/service_manager.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <pthread.h>
#include <thread>

namespace tpc {

static constexpr auto EndPatience = std::chrono::milliseconds(500);
static constexpr int64_t StartNs = 10'000'000;
static constexpr auto Moment = std::chrono::milliseconds(1);
static constexpr std::chrono::seconds Silence{5};

static std::atomic<int> Users{0};
static std::atomic<bool> Over{false};
static std::atomic<bool> Up{false};
static std::atomic<int64_t> StartedAt{0};
static std::atomic<bool> Asking{false};
static std::atomic<std::chrono::steady_clock::rep> AskedAt{0};
static std::atomic<bool> Forked{false};

static void inChild() {
  Users = 0;
  Asking = false;
  if (ros::isInitialized())
    Forked = true;
}

// While this library is loaded, no second thread can be in it yet.
static const int Watched = pthread_atfork(nullptr, nullptr, inChild);

RosUse::RosUse() : Held(false) {
  if (Forked || Watched != 0)
    return;
  ++Users;
  Held = !Over;
  if (!Held)
    --Users;
}

RosUse::~RosUse() {
  if (Held)
    --Users;
}

bool forkedFromNode() { return Forked; }

bool rosIsUp() {
  if (!ros::isStarted() || ros::isShuttingDown()) {
    Up = false;
    StartedAt = 0;
    return false;
  }
  if (Up)
    return true;
  // Asking for a singleton of roscpp creates it, and singletons are destroyed
  // in the opposite order: ros::start() must create its own first.
  const auto Now = std::chrono::steady_clock::now().time_since_epoch().count();
  int64_t Unset = 0;
  StartedAt.compare_exchange_strong(Unset, Now);
  if (Now - StartedAt < StartNs)
    return false;
  // ros::isStarted() is true from the beginning of ros::start(), when neither
  // the addresses of this node nor its threads exist. This service is the last
  // thing visible from outside that every node creates in ros::start().
  if (!ros::ServiceManager::instance()->lookupServicePublication(
          ros::names::resolve("~set_logger_level")))
    return false;
  // Registered now, it runs before the destructors of everything that
  // ros::start() created: handlers run in the opposite order.
  static const int Registered = std::atexit([] {
    endRuntime();
    endRosUse();
  });
  Up = Registered == 0;
  return Up;
}

/// A master that takes the question and never answers, such as a stopped one,
/// is no error to roscpp.
static void warnOfSilence() {
  static std::atomic<bool> Said{false};
  const auto Since =
      std::chrono::steady_clock::now().time_since_epoch().count() - AskedAt;
  if (Since > std::chrono::nanoseconds(Silence).count() && !Said.exchange(true))
    warn("the ROS master has not answered for " +
         std::to_string(Silence.count()) +
         " s: until it does, TPC's settings on the parameter server are not "
         "read, and topics that are not advertised yet get no reports");
}

bool askMaster(std::function<void()> Job) {
  if (Asking.exchange(true)) {
    warnOfSilence();
    return false;
  }
  AskedAt = std::chrono::steady_clock::now().time_since_epoch().count();
  // The signals of a node are for the node's own threads.
  sigset_t All, Before;
  sigfillset(&All);
  pthread_sigmask(SIG_SETMASK, &All, &Before);
  bool Taken = true;
  try {
    std::thread([Job = std::move(Job)] {
      try {
        RosUse Use;
        if (Use)
          Job();
      } catch (const std::exception &Error) {
        warn(std::string("talking to the ROS master failed: ") + Error.what());
      } catch (...) {
        // xmlrpcpp throws exceptions that are not derived from std::exception.
        warn("talking to the ROS master failed");
      }
      Asking = false;
      wakeHelper();
    }).detach();
  } catch (const std::exception &) {
    // No thread is available; the next poll tries again.
    Taken = Asking = false;
  }
  pthread_sigmask(SIG_SETMASK, &Before, nullptr);
  return Taken;
}

void endRosUse() {
  if (Forked || Over)
    return;
  Over = true;
  const auto Until = std::chrono::steady_clock::now() + EndPatience;
  while (Users > 0 && std::chrono::steady_clock::now() < Until)
    std::this_thread::sleep_for(Moment);
}

void WakingQueue::addCallback(const ros::CallbackInterfacePtr &Callback,
                              uint64_t Owner) {
  CallbackQueue::addCallback(Callback, Owner);
  wakeHelper();
}

} // namespace tpc
