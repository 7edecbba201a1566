//===- Arguments.cpp ------------------------------------------------------===//
#include "ros2/Arguments.h"
#include "ros2/Rcl.h"

#include <rcl/arguments.h>
#include <rcl_yaml_param_parser/parser.h>

#include <cctype>
#include <dlfcn.h>
#include <fstream>
#include <iterator>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace tpc {

/// The words of the command line of this process.
static std::vector<std::string> commandLine() {
  std::ifstream File("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> Words;
  for (std::string Word; std::getline(File, Word, '\0');)
    Words.push_back(Word);
  return Words;
}

/// Whether this process holds components: its own node then has the name that
/// rclcpp_components gives it.
static bool isContainer() {
  void *Library =
      dlopen("libcomponent_manager.so", RTLD_LAZY | RTLD_NOLOAD | RTLD_LOCAL);
  if (Library)
    dlclose(Library);
  return Library;
}

bool isNamedByCommandLine() {
  if (isContainer())
    return true;
  for (const std::string &Word : commandLine())
    if (Word.rfind("__node:=", 0) == 0)
      return true;
  return false;
}

std::string nameByCommandLine() {
  std::string Name, Namespace;
  const std::vector<std::string> Words = commandLine();
  for (const std::string &Word : Words) {
    if (Word.rfind("__node:=", 0) == 0)
      Name = Word.substr(8);
    if (Word.rfind("__ns:=", 0) == 0)
      Namespace = Word.substr(6);
  }
  if (Name.empty() && isContainer())
    Name = "ComponentManager";
  if (Name.empty()) {
    const std::string Program = Words.empty() ? "" : Words[0];
    Name =
        Program.substr(Program.rfind('/') + 1) + "_" + std::to_string(getpid());
    for (char &C : Name)
      if (!std::isalnum(static_cast<unsigned char>(C)))
        C = '_';
    if (std::isdigit(static_cast<unsigned char>(Name[0])))
      Name = "_" + Name;
  }
  if (Namespace.empty() || Namespace[0] != '/')
    Namespace = "/" + Namespace;
  return Namespace + (Namespace.back() == '/' ? "" : "/") + Name;
}

/// Whether the parts of \p Pattern (`*`: any one, `**`: any number of them) are
/// those of \p Name; both begin with a slash, or are empty.
static bool matches(std::string_view Pattern, std::string_view Name) {
  if (Pattern.empty())
    return Name.empty();
  const size_t Ends = Pattern.find('/', 1);
  const std::string_view Part = Pattern.substr(0, Ends);
  const std::string_view Rest =
      Ends == std::string_view::npos ? "" : Pattern.substr(Ends);
  if (Part == "/**" && matches(Rest, Name))
    return true;
  if (Name.empty())
    return false;
  const size_t NameEnds = Name.find('/', 1);
  const std::string_view NameRest =
      NameEnds == std::string_view::npos ? "" : Name.substr(NameEnds);
  if (Part == "/**")
    return matches(Pattern, NameRest);
  return (Part == "/*" || Part == Name.substr(0, NameEnds)) &&
         matches(Rest, NameRest);
}

static void visitAll(const rcl_params_t &All, const std::string &FullName,
                     const std::function<void(const std::string &,
                                              const rcl_variant_t &)> &Visit) {
  const std::string Last = FullName.substr(FullName.rfind('/'));
  for (size_t I = 0; I < All.num_nodes; ++I) {
    std::string Pattern = All.node_names[I];
    if (Pattern[0] != '/')
      Pattern = "/" + Pattern;
    // A rule of the command line names a node without its namespace.
    const bool IsOfAll = Pattern == Last;
    if (Pattern.substr(Pattern.rfind('/')) != Last ||
        !(IsOfAll || matches(Pattern, FullName)))
      continue;
    const rcl_node_params_t &Of = All.params[I];
    for (size_t P = 0; P < Of.num_params; ++P)
      Visit(Of.parameter_names[P], Of.parameter_values[P]);
  }
}

void forEachOverride(const std::string &FullName,
                     const std::function<void(const std::string &,
                                              const rcl_variant_t &)> &Visit) {
  const std::vector<std::string> Words = commandLine();
  std::vector<const char *> Pointers;
  Pointers.reserve(Words.size());
  for (const std::string &Word : Words)
    Pointers.push_back(Word.c_str());
  rcl_arguments_t Arguments = rcl_get_zero_initialized_arguments();
  if (!isOk(rcl_parse_arguments(static_cast<int>(Pointers.size()),
                                Pointers.data(), rcl_get_default_allocator(),
                                &Arguments)))
    return;
  rcl_params_t *All = nullptr;
  if (isOk(rcl_arguments_get_param_overrides(&Arguments, &All)) && All) {
    visitAll(*All, FullName, Visit);
    rcl_yaml_node_struct_fini(All);
  }
  isOk(rcl_arguments_fini(&Arguments));
}

} // namespace tpc
