//===- PlansFolder.h - What the processes of a link unit found ------------===//
//
// `pytpc build` keeps a folder for each link unit: the plans of the processes
// that it is part of, or, until they are known, the file `later`.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PLANSFOLDER_H
#define TPC_PLANSFOLDER_H

#include <string>
#include <vector>

namespace tpc {

/// The plans in the folder of this link unit, in the order of their names.
std::vector<std::string> plansOfFolder();

/// True if this link unit is linked again when its processes were analysed:
/// `later` is in the folder, and the unit is a library, has plans already, or
/// uses a library below the folder that `later` names. What uses none is a
/// whole program by itself.
bool isAnalysedLater();

} // namespace tpc

#endif // TPC_PLANSFOLDER_H
