//===- Settings.cpp -------------------------------------------------------===//
#include "ros2/Settings.h"
#include "Config.h"
#include "Runtime.h"
#include "ros2/Arguments.h"
#include "ros2/Rcl.h"
#include "ros2/RclGraph.h"

#include <rcl/service.h>
#include <rcl_interfaces/msg/parameter_descriptor.h>
#include <rcl_interfaces/msg/parameter_type.h>
#include <rcl_interfaces/msg/parameter_value.h>
#include <rcl_interfaces/msg/set_parameters_result.h>
#include <rcl_interfaces/srv/describe_parameters.h>
#include <rcl_interfaces/srv/get_parameter_types.h>
#include <rcl_interfaces/srv/get_parameters.h>
#include <rcl_interfaces/srv/list_parameters.h>
#include <rcl_interfaces/srv/set_parameters.h>
#include <rcl_interfaces/srv/set_parameters_atomically.h>
#include <rmw/qos_profiles.h>
#include <rosidl_runtime_c/primitives_sequence_functions.h>
#include <rosidl_runtime_c/string_functions.h>

#include <charconv>
#include <iterator>
#include <optional>
#include <string_view>

namespace tpc {
namespace {

using Parameter = rcl_interfaces__msg__Parameter;
using Value = rcl_interfaces__msg__ParameterValue;
using Names = rosidl_runtime_c__String__Sequence;
using Result = rcl_interfaces__msg__SetParametersResult;
constexpr uint8_t NotSet =
                      rcl_interfaces__msg__ParameterType__PARAMETER_NOT_SET,
                  Bool = rcl_interfaces__msg__ParameterType__PARAMETER_BOOL,
                  Integer =
                      rcl_interfaces__msg__ParameterType__PARAMETER_INTEGER,
                  Double = rcl_interfaces__msg__ParameterType__PARAMETER_DOUBLE,
                  Text = rcl_interfaces__msg__ParameterType__PARAMETER_STRING;

//===----------------------------------------------------------------------===//
// The parameters
//===----------------------------------------------------------------------===//

struct Known {
  const char *Name;
  uint8_t Type;
  const char *About;
};

constexpr Known All[] = {
    {"sink", Text, "where reports go: auto, rosout, topic, file or off"},
    {"policy", Text, "what is reported: every, edges or light"},
    {"period", Double, "seconds of one summary"},
    {"site_cap", Integer, "reports per second of one comparison; 0: no cap"},
    {"process_cap", Integer, "reports per second of the process; 0: no cap"},
    {"status", Text, "the settings in force, and what became of the reports"}};
constexpr std::string_view Status = "status";

const Known *find(std::string_view Name) {
  for (const Known &K : All)
    if (K.Name == Name)
      return &K;
  return nullptr;
}

std::string_view textOf(const rosidl_runtime_c__String &S) {
  return {S.data, S.size};
}

bool assign(rosidl_runtime_c__String &To, const std::string &From) {
  return rosidl_runtime_c__String__assignn(&To, From.data(), From.size());
}

void fill(Value &V, const Known &Of) {
  const Config C = current().filledIn();
  const std::string_view Name = Of.Name;
  V.type = Of.Type;
  if (Name == "sink")
    assign(V.string_value, text(C.Sink));
  else if (Name == "policy")
    assign(V.string_value, text(C.Policy));
  else if (Name == "period")
    V.double_value = static_cast<double>(C.PeriodNs) / 1e9;
  else if (Name == "site_cap")
    V.integer_value = static_cast<int64_t>(C.SiteCap);
  else if (Name == "process_cap")
    V.integer_value = static_cast<int64_t>(C.ProcessCap);
  else
    assign(V.string_value, statusLine());
}

/// A number as text that reads back as the same one.
std::string shortest(double X) {
  char Buffer[32];
  return {Buffer, std::to_chars(Buffer, std::end(Buffer), X).ptr};
}

/// The text that a variable of the environment has for \p V; nothing if it is
/// of another type. `ros2 param set` reads `off` as false.
std::optional<std::string> textOf(const Parameter &P) {
  const Value &V = P.value;
  if (V.type == Text)
    return std::string(textOf(V.string_value));
  if (V.type == Integer)
    return std::to_string(V.integer_value);
  if (V.type == Double)
    return shortest(V.double_value);
  if (V.type == Bool && !V.bool_value && textOf(P.name) == "sink")
    return "off";
  return std::nullopt;
}

/// The same for a value of the command line.
std::optional<std::string> textOf(const std::string &Name,
                                  const rcl_variant_t &V) {
  if (V.string_value)
    return V.string_value;
  if (V.integer_value)
    return std::to_string(*V.integer_value);
  if (V.double_value)
    return shortest(*V.double_value);
  if (V.bool_value && !*V.bool_value && Name == "sink")
    return "off";
  return std::nullopt;
}

/// Sets \p Name in \p C. If that is not possible, returns false and sets \p
/// Why.
bool take(Config &C, const std::string &Name,
          const std::optional<std::string> &Given, std::string &Why) {
  Why = Name + ": there is no such setting";
  if (!find(Name))
    return false;
  Why = Name + ": it is read-only";
  if (Name == Status)
    return false;
  Why = "it is of the wrong type";
  const bool IsTaken = Given && parse(C, Name, *Given, Why);
  Why = Name + ": " + Why;
  return IsTaken;
}

/// Applies \p C. If that is not possible, returns false and sets \p Why.
bool use(const Config &C, std::string &Why) {
  Why = "it cannot be applied; the previous settings stay";
  return apply(C);
}

void fill(Result &R, bool IsDone, const std::string &Why) {
  R.successful = IsDone;
  if (!IsDone)
    assign(R.reason, Why);
}

//===----------------------------------------------------------------------===//
// The services
//===----------------------------------------------------------------------===//

void answer(const rcl_interfaces__srv__GetParameters_Request &Asked,
            rcl_interfaces__srv__GetParameters_Response &To) {
  // As rclcpp does it: a name that is not known has no value at all.
  if (!rcl_interfaces__msg__ParameterValue__Sequence__init(&To.values,
                                                           Asked.names.size))
    return;
  size_t Count = 0;
  for (size_t I = 0; I < Asked.names.size; ++I)
    if (const Known *K = find(textOf(Asked.names.data[I])))
      fill(To.values.data[Count++], *K);
  if (Count < To.values.size)
    rcl_interfaces__msg__ParameterValue__Sequence__fini(&To.values);
}

void answer(const rcl_interfaces__srv__GetParameterTypes_Request &Asked,
            rcl_interfaces__srv__GetParameterTypes_Response &To) {
  if (!rosidl_runtime_c__uint8__Sequence__init(&To.types, Asked.names.size))
    return;
  for (size_t I = 0; I < Asked.names.size; ++I) {
    const Known *K = find(textOf(Asked.names.data[I]));
    To.types.data[I] = K ? K->Type : NotSet;
  }
}

void answer(const rcl_interfaces__srv__SetParameters_Request &Asked,
            rcl_interfaces__srv__SetParameters_Response &To) {
  const auto &Given = Asked.parameters;
  if (!rcl_interfaces__msg__SetParametersResult__Sequence__init(&To.results,
                                                                Given.size))
    return;
  for (size_t I = 0; I < Given.size; ++I) {
    Config C = current();
    std::string Why;
    const bool IsDone = take(C, std::string(textOf(Given.data[I].name)),
                             textOf(Given.data[I]), Why) &&
                        use(C, Why);
    fill(To.results.data[I], IsDone, Why);
  }
}

void answer(const rcl_interfaces__srv__SetParametersAtomically_Request &Asked,
            rcl_interfaces__srv__SetParametersAtomically_Response &To) {
  Config C = current();
  std::string Why;
  for (size_t I = 0; I < Asked.parameters.size; ++I) {
    const Parameter &P = Asked.parameters.data[I];
    if (!take(C, std::string(textOf(P.name)), textOf(P), Why))
      return fill(To.result, false, Why);
  }
  fill(To.result, use(C, Why), Why);
}

/// Whether \p Name is \p Prefix, or below it. No name here has a dot.
bool isListed(std::string_view Name, const Names &Prefixes) {
  for (size_t I = 0; I < Prefixes.size; ++I)
    if (textOf(Prefixes.data[I]) == Name)
      return true;
  return Prefixes.size == 0;
}

void answer(const rcl_interfaces__srv__ListParameters_Request &Asked,
            rcl_interfaces__srv__ListParameters_Response &To) {
  size_t Count = 0;
  for (const Known &K : All)
    Count += isListed(K.Name, Asked.prefixes);
  if (!rosidl_runtime_c__String__Sequence__init(&To.result.names, Count))
    return;
  size_t I = 0;
  for (const Known &K : All)
    if (isListed(K.Name, Asked.prefixes))
      assign(To.result.names.data[I++], K.Name);
}

void answer(const rcl_interfaces__srv__DescribeParameters_Request &Asked,
            rcl_interfaces__srv__DescribeParameters_Response &To) {
  if (!rcl_interfaces__msg__ParameterDescriptor__Sequence__init(
          &To.descriptors, Asked.names.size))
    return;
  for (size_t I = 0; I < Asked.names.size; ++I) {
    rcl_interfaces__msg__ParameterDescriptor &D = To.descriptors.data[I];
    assign(D.name, std::string(textOf(Asked.names.data[I])));
    if (const Known *K = find(textOf(Asked.names.data[I]))) {
      D.type = K->Type;
      D.read_only = K->Name == Status;
      assign(D.description, K->About);
    }
  }
}

/// What the services have in common.
class AnyService {
public:
  AnyService(const char *Name, const rosidl_service_type_support_t *Type)
      : Name(Name), Type(Type) {}
  bool begin(const std::string &Node);
  /// Answers all requests that wait.
  virtual void serve() = 0;
  void end();
  bool rings() const { return Rings; }

protected:
  ~AnyService() = default;
  rcl_service_t Service = rcl_get_zero_initialized_service();

private:
  const char *const Name;
  const rosidl_service_type_support_t *const Type;
  bool IsMade = false;
  bool Rings = false; ///< the helper thread is woken for a request
};

bool AnyService::begin(const std::string &Node) {
  rcl_service_options_t Options = rcl_service_get_default_options();
  Options.qos = rmw_qos_profile_parameters;
  IsMade = rcl_service_init(&Service, &RclGraph::of().node(), Type,
                            (Node + "/_tpc/" + Name).c_str(),
                            &Options) == RCL_RET_OK;
  Rings = IsMade &&
          isOk(rcl_service_set_on_new_request_callback(
              &Service, [](const void *, size_t) { wakeHelper(); }, nullptr));
  return IsMade;
}

void AnyService::end() {
  if (IsMade)
    isOk(rcl_service_fini(&Service, &RclGraph::of().node()));
  IsMade = false;
}

#define TPC_SERVICE(Class, Kind, Name)                                         \
  class Class final : public AnyService {                                      \
  public:                                                                      \
    Class()                                                                    \
        : AnyService(Name,                                                     \
                     ROSIDL_GET_SRV_TYPE_SUPPORT(rcl_interfaces, srv, Kind)) { \
    }                                                                          \
    void serve() override {                                                    \
      for (bool Is = true; Is;) {                                              \
        rcl_interfaces__srv__##Kind##_Request Asked;                           \
        rcl_interfaces__srv__##Kind##_Response To;                             \
        rmw_request_id_t Id;                                                   \
        if (!rcl_interfaces__srv__##Kind##_Request__init(&Asked))              \
          return;                                                              \
        Is = isOk(rcl_take_request(&Service, &Id, &Asked));                    \
        if (Is && rcl_interfaces__srv__##Kind##_Response__init(&To)) {         \
          answer(Asked, To);                                                   \
          isOk(rcl_send_response(&Service, &Id, &To));                         \
          rcl_interfaces__srv__##Kind##_Response__fini(&To);                   \
        }                                                                      \
        rcl_interfaces__srv__##Kind##_Request__fini(&Asked);                   \
      }                                                                        \
    }                                                                          \
  }

TPC_SERVICE(GetService, GetParameters, "get_parameters");
TPC_SERVICE(TypesService, GetParameterTypes, "get_parameter_types");
TPC_SERVICE(SetService, SetParameters, "set_parameters");
TPC_SERVICE(SetAllService, SetParametersAtomically,
            "set_parameters_atomically");
TPC_SERVICE(ListService, ListParameters, "list_parameters");
TPC_SERVICE(DescribeService, DescribeParameters, "describe_parameters");

/// Never destroyed, as everything here.
struct Services {
  GetService Get;
  TypesService Types;
  SetService Set;
  SetAllService SetAll;
  ListService List;
  DescribeService Describe;

  template <typename Function> void each(Function Visit) {
    for (AnyService *S :
         {static_cast<AnyService *>(&Get), static_cast<AnyService *>(&Types),
          static_cast<AnyService *>(&Set), static_cast<AnyService *>(&SetAll),
          static_cast<AnyService *>(&List),
          static_cast<AnyService *>(&Describe)})
      Visit(*S);
  }

  static Services &all() {
    static auto &Only = *new Services;
    return Only;
  }
};

/// Applies what the command line and its files have for the node.
void applyOverrides(const std::string &Node) {
  Config C = current();
  forEachOverride(Node + "/_tpc", [&](const std::string &Name,
                                      const rcl_variant_t &V) {
    std::string Why;
    if (!take(C, Name, textOf(Name, V), Why))
      warn("the parameter " + Node + "/_tpc/" + Name + " is ignored: " + Why);
  });
  if (!(C == current()))
    apply(C);
}

} // namespace

bool beginSettings(const std::string &Name, std::string &Why) {
  applyOverrides(Name);
  bool IsDone = true;
  Services::all().each([&](AnyService &S) {
    if (!S.begin(Name)) {
      Why = reasonOfRcl();
      IsDone = false;
    }
  });
  return IsDone;
}

bool serveSettings() {
  bool Rings = true;
  Services::all().each([&](AnyService &S) {
    S.serve();
    Rings &= S.rings();
  });
  return Rings;
}

void endSettings() {
  Services::all().each([](AnyService &S) { S.end(); });
}

} // namespace tpc
