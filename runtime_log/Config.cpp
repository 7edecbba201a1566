//===- Config.cpp ---------------------------------------------------------===//
#include "Config.h"

#include "Runtime.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>

namespace tpc {

const char *const ConfigNames[10] = {
    "sink",   "policy",     "period",       "site_cap", "process_cap",
    "folder", "file_limit", "file_reserve", "ring",     "ring_budget"};

static constexpr const char *SinkNames[] = {"auto", "rosout", "topic", "file",
                                            "off"};
static constexpr const char *PolicyNames[] = {"every", "edges", "light"};

const char *text(SinkKind K) { return SinkNames[static_cast<int>(K)]; }
const char *text(Policy P) { return PolicyNames[static_cast<int>(P)]; }

bool Config::operator==(const Config &Other) const {
  return Sink == Other.Sink && Policy == Other.Policy &&
         PeriodNs == Other.PeriodNs && SiteCap == Other.SiteCap &&
         ProcessCap == Other.ProcessCap && Folder == Other.Folder &&
         FileLimitMiB == Other.FileLimitMiB &&
         FileReserveMiB == Other.FileReserveMiB && RingNs == Other.RingNs &&
         RingBudgetMiB == Other.RingBudgetMiB;
}

uint64_t Config::segmentBytes() const {
  // One extent of 1 MiB, and the header.
  constexpr uint64_t Least = (uint64_t(1) << 20) + 4096;
  return std::max((RingBudgetMiB << 20) / Segments, Least);
}

Config Config::filledIn() const {
  // `light` sends about a kilobyte a second for each ten comparisons, and
  // readers spread a summary over its period.
  struct Defaults {
    uint64_t PeriodNs, SiteCap, ProcessCap;
  };
  static constexpr Defaults OfLight{1'000'000'000, 10, 50};
  static constexpr Defaults OfOthers{100'000'000, 0, 0};
  Config C = *this;
  if (C.Policy == Policy::OfSink)
    C.Policy = C.Sink == SinkKind::Auto ? Policy::Light : Policy::Every;
  const Defaults &D = C.Policy == Policy::Light ? OfLight : OfOthers;
  auto Fill = [](uint64_t &To, uint64_t Default) {
    if (To == Usual)
      To = Default;
  };
  Fill(C.PeriodNs, D.PeriodNs);
  Fill(C.SiteCap, D.SiteCap);
  Fill(C.ProcessCap, D.ProcessCap);
  return C;
}

template <typename Enum, size_t N>
static bool choose(Enum &E, const char *const (&Names)[N],
                   const std::string &Value, std::string &Why) {
  Why = "it must be one of";
  for (size_t I = 0; I < N; ++I) {
    if (Value == Names[I]) {
      E = static_cast<Enum>(I);
      return true;
    }
    Why += std::string(I ? ", " : " ") + Names[I];
  }
  return false;
}

template <typename Number>
static bool read(Number &X, const std::string &Value, Number Least,
                 Number Most) {
  Number Read{};
  const char *End = Value.data() + Value.size();
  auto [Rest, Error] = std::from_chars(Value.data(), End, Read);
  if (Error != std::errc() || Rest != End || !(Read >= Least && Read <= Most))
    return false;
  X = Read;
  return true;
}

static bool count(uint64_t &X, const std::string &Value, std::string &Why) {
  Why = "it must be a whole number";
  return read<uint64_t>(X, Value, 0, uint64_t(1) << 40);
}

bool parse(Config &C, const std::string &Name, const std::string &Value,
           std::string &Why) {
  if (Name == "sink")
    return choose(C.Sink, SinkNames, Value, Why);
  if (Name == "policy")
    return choose(C.Policy, PolicyNames, Value, Why);
  if (Name == "period") {
    double Seconds;
    Why = "it must be a number of seconds from 0.001 to 3600";
    if (!read<double>(Seconds, Value, 1e-3, 3600))
      return false;
    C.PeriodNs = static_cast<uint64_t>(Seconds * 1e9);
    return true;
  }
  if (Name == "site_cap")
    return count(C.SiteCap, Value, Why);
  if (Name == "process_cap")
    return count(C.ProcessCap, Value, Why);
  if (Name == "file_limit")
    return count(C.FileLimitMiB, Value, Why);
  if (Name == "file_reserve")
    return count(C.FileReserveMiB, Value, Why);
  if (Name == "ring") {
    double Minutes;
    Why = "it must be a number of minutes, 0 or from 0.05 to 10080";
    if (!read<double>(Minutes, Value, 0, 10080) || (Minutes && Minutes < 0.05))
      return false;
    C.RingNs = static_cast<uint64_t>(Minutes * 60e9);
    return true;
  }
  if (Name == "ring_budget") {
    Why = "it must be a whole number of MiB from 4";
    return read<uint64_t>(C.RingBudgetMiB, Value, 4, uint64_t(1) << 24);
  }
  if (Name == "folder") {
    C.Folder = Value;
    return true;
  }
  Why = "there is no such setting";
  return false;
}

std::string variableOf(const std::string &Name) {
  std::string Variable = "TPC_";
  for (char C : Name)
    Variable += static_cast<char>(std::toupper(C));
  return Variable;
}

Config configOfEnvironment() {
  Config C;
  for (const char *Name : ConfigNames) {
    const std::string Variable = variableOf(Name);
    const char *Value = std::getenv(Variable.c_str());
    std::string Why;
    if (Value && *Value && !parse(C, Name, Value, Why))
      warn(Variable + "=" + Value + " is ignored: " + Why);
  }
  return C;
}

} // namespace tpc
