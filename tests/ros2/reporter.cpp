//===- reporter.cpp - A node on rcl alone that reports --------------------===//
//
// reporter NODE NAMESPACE [--ros-args ...]; reads one command from each line.
// $REPORTER_DOMAIN is the number of its graph, in place of $ROS_DOMAIN_ID.
//
//   report N PAUSE_US   N reports, the values 0 to N-1; the outcome alternates
//   follow              the node's clock follows /clock
//   simulated NS        it follows /clock, which is NS
//   read NAME           a parameter is read
//   node NAME           one more node
//   read_on NAME        a parameter of that node is read
//   made NODE AT SIZE   the object at this address is a node
//   read_in NODE NAME AT SIZE   an object there reads a parameter of the node
//   of AT N             N reports of the object there
//   fork N              N reports in a child, which leaves by _exit
//   child N             N reports in a child, which leaves by exit; prints its
//                       status in place of `ok`
//   shutdown            ends the node
//   exit | quick        returns from main | _exit
//
// Prints `ok` when it is done.
//
// With LATE, it is a program that is not built with the log library: the
// command `load FILE` loads that, once there is a node, as a container of
// components does.
//
//===----------------------------------------------------------------------===//
#include "LogOne.h"

#include <rcl/error_handling.h>
#include <rcl/node.h>
#include <rcl/rcl.h>
#include <rcl/time.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#ifdef LATE
#include <dlfcn.h>
static void *Library = nullptr;
#define CALL(Function, Name)                                                   \
  (*reinterpret_cast<decltype(&Function)>(dlsym(Library, Name)))
#else
#define CALL(Function, Name) Function
#endif

static char Key[] = "00000001-0000-5000-8000-000000000000";
static char ReadKey[] = "00000002-0000-5000-8000-000000000000";

static void check(rcl_ret_t Result) {
  if (Result == RCL_RET_OK)
    return;
  std::fprintf(stderr, "rcl: %s\n", rcl_get_error_string().str);
  std::_Exit(3);
}

static void report(long Count, long PauseUs) {
  auto Next = std::chrono::steady_clock::now();
  for (long I = 0; I < Count; ++I) {
    CALL(log_one, "_Z7log_onePcbddb")(Key, I % 2, static_cast<double>(I), 0.5,
                                      I % 2);
    Next += std::chrono::microseconds(PauseUs);
    if (PauseUs)
      std::this_thread::sleep_until(Next);
  }
}

static void answer() {
  std::puts("ok");
  std::fflush(stdout);
}

int main(int Count, char **Words) {
  rcl_allocator_t Allocator = rcl_get_default_allocator();
  rcl_init_options_t Options = rcl_get_zero_initialized_init_options();
  check(rcl_init_options_init(&Options, Allocator));
  if (const char *Domain = std::getenv("REPORTER_DOMAIN"))
    check(
        rcl_init_options_set_domain_id(&Options, std::strtoul(Domain, {}, 10)));
  rcl_context_t Context = rcl_get_zero_initialized_context();
  check(rcl_init(Count, Words, &Options, &Context));
  rcl_node_options_t Of = rcl_node_get_default_options();
  rcl_node_t Node = rcl_get_zero_initialized_node();
  rcl_node_t Second = rcl_get_zero_initialized_node();
  check(rcl_node_init(&Node, Words[1], Words[2], &Context, &Of));
  rcl_clock_t Clock;
  check(rcl_clock_init(RCL_ROS_TIME, &Clock, &Allocator));
  answer();
  for (std::string Command; std::cin >> Command;) {
    if (Command == "report") {
      long Reports, PauseUs;
      std::cin >> Reports >> PauseUs;
      report(Reports, PauseUs);
#ifdef LATE
    } else if (Command == "load") {
      std::string File;
      std::cin >> File;
      Library = dlopen(File.c_str(), RTLD_LAZY | RTLD_LOCAL);
      if (!Library)
        std::puts(dlerror());
#endif
    } else if (Command == "follow") {
      check(rcl_enable_ros_time_override(&Clock));
    } else if (Command == "simulated") {
      int64_t Ns;
      std::cin >> Ns;
      check(rcl_enable_ros_time_override(&Clock));
      check(rcl_set_ros_time_override(&Clock, Ns));
    } else if (Command == "read") {
      std::string Name;
      std::cin >> Name;
      CALL(log_read, "_Z8log_readPcPKvS1_b")(ReadKey, nullptr, &Name, false);
    } else if (Command == "read_on") {
      std::string Name;
      std::cin >> Name;
      CALL(log_read, "_Z8log_readPcPKvS1_b")(ReadKey, &Second, &Name, false);
    } else if (Command == "made") {
      std::string Name;
      uintptr_t At, Size;
      std::cin >> Name >> At >> Size;
      CALL(log_node, "_Z8log_nodePKcPKvm")(Name.c_str(),
                                           reinterpret_cast<void *>(At), Size);
    } else if (Command == "read_in") {
      std::string Of, Name;
      uintptr_t At, Size;
      std::cin >> Of >> Name >> At >> Size;
      CALL(log_read_in,
           "_Z11log_read_inPcPKcPKvbS3_m")(ReadKey, Of.c_str(), &Name, false,
                                           reinterpret_cast<void *>(At), Size);
    } else if (Command == "of") {
      uintptr_t At;
      long Reports;
      std::cin >> At >> Reports;
      for (long I = 0; I < Reports; ++I)
        CALL(log_one_of,
             "_Z10log_one_ofPcbddbPKv")(Key, I % 2, static_cast<double>(I), 0.5,
                                        I % 2, reinterpret_cast<void *>(At));
    } else if (Command == "node") {
      std::string Name;
      std::cin >> Name;
      check(rcl_node_init(&Second, Name.c_str(), "/", &Context, &Of));
    } else if (Command == "fork") {
      long Reports;
      std::cin >> Reports;
      const pid_t Child = fork();
      if (!Child) {
        report(Reports, 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        std::_Exit(0);
      }
      waitpid(Child, nullptr, 0);
    } else if (Command == "child") {
      long Reports;
      std::cin >> Reports;
      const pid_t Child = fork();
      if (!Child) {
        report(Reports, 0);
        std::exit(0);
      }
      int Status;
      waitpid(Child, &Status, 0);
      std::printf("%d\n", Status);
      std::fflush(stdout);
      continue;
    } else if (Command == "shutdown") {
      check(rcl_node_fini(&Node));
      check(rcl_shutdown(&Context));
    } else if (Command == "exit") {
      break;
    } else if (Command == "quick") {
      std::_Exit(0);
    }
    answer();
  }
}
