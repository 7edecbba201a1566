//===- Arguments.h - What the command line says of ROS --------------------===//
#ifndef TPC_ARGUMENTS_H
#define TPC_ARGUMENTS_H

#include <rcl_yaml_param_parser/types.h>

#include <functional>
#include <string>

namespace tpc {

/// Whether the name of the process's node does not depend on its program.
bool isNamedByCommandLine();

/// The name of the first node after the command line's `__node` and `__ns`, or
/// else as a container of components, or after the program and this process.
std::string nameByCommandLine();

/// Calls \p Visit(parameter, value) for each value that the command line, or a
/// file of parameters that it names, has for the node \p FullName: by that name
/// or by one with `*` or `**` whose last part is that of \p FullName. Such a
/// file has values of other nodes under a lone `/**`.
void forEachOverride(const std::string &FullName,
                     const std::function<void(const std::string &,
                                              const rcl_variant_t &)> &Visit);

} // namespace tpc

#endif // TPC_ARGUMENTS_H
