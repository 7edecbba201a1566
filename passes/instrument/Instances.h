//===- Instances.h - Objects that have parameters of their own ------------===//
//
// Two objects of a class that reads parameters are two instances (global and
// local costmap): what one of them evaluates is reported apart from what the
// other one does. A report gets the address of the object whose threshold it
// compares, if the class of that object
//
// - reads parameters in its methods, or is filled by a read,
// - or is a base class or a member of such a class, or derived from it.
//
// An object of any other class, such as one of many obstacles, is none: a
// comparison there has one report for all objects, as in a free function. Nor
// is the argument of a function one, unless its methods read parameters: it
// may be a copy, such as the settings that dynamic_reconfigure passes, and has
// another address each time.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_INSTANCES_H
#define TPC_INSTANCES_H

#include "instrument/Prepare.h"
#include "params/ParamCallFinder.h"
#include "results/GatherResults.h"
#include "support/DebugTypes.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/IR/Dominators.h"

namespace tpc {

/// The object that \p F is a method of; null if it is none, or static.
llvm::Argument *objectOf(llvm::Function &F);

/// The class that \p F is a method of; null if it is none.
const llvm::DICompositeType *classOf(const llvm::Function &F);

class Instances {
public:
  /// \p Reads are those of the copy of \p Analysed.
  Instances(const AnalysedModule &Analysed, DebugTypes &Types,
            llvm::ArrayRef<ParameterRead> Reads);

  /// The object whose threshold \p C compares, in the original program; null if
  /// it is no instance, or not known before \p Before.
  llvm::Value *objectOf(const Comparison &C, llvm::Instruction &Before);

private:
  void addReader(const llvm::DIType *T, bool InMethod);
  void addPart(const llvm::DICompositeType &Class);
  bool isConfig(const llvm::DICompositeType &Class) const;
  void addParts(const llvm::DICompositeType &Class);
  bool isInstance(const llvm::DIType *T);
  bool isDerived(const llvm::DICompositeType &Class,
                 const llvm::DenseSet<unsigned> &From);
  bool reads(const llvm::DIType *T);
  bool canHold(const llvm::Value &Object);
  llvm::Value *holderOf(llvm::Value *Threshold);
  bool dominates(const llvm::Value &V, llvm::Instruction &Before);

  const AnalysedModule &Analysed;
  DebugTypes &Types;
  llvm::DenseSet<unsigned> Readers; ///< numbers of classes
  llvm::DenseSet<unsigned> Reading; ///< those of Readers whose methods read
  llvm::DenseSet<unsigned> Parts;   ///< bases and members of those
  llvm::DenseSet<unsigned> Defined; ///< those of both whose members are known
  llvm::StringSet<> Configs;        ///< names of classes of settings
  llvm::DenseMap<llvm::Function *, std::unique_ptr<llvm::DominatorTree>> Trees;
};

} // namespace tpc

#endif // TPC_INSTANCES_H
