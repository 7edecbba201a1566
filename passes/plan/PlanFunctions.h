//===- PlanFunctions.h - The functions of a plan in a link unit -----------===//
//
// A plan is about a program that may be larger than the link unit: a whole
// process. Its functions are found in the unit by their names, those that only
// one file sees by name, file and line; with another body they are none.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PLANFUNCTIONS_H
#define TPC_PLANFUNCTIONS_H

#include "instrument/Separation.h"
#include "plan/Plan.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/StringMap.h"

namespace tpc {

/// The functions that a module defines. Copies for single calls are not among
/// them.
class DefinedFunctions {
public:
  /// \p Unit is the full name of the link unit: its package and name.
  DefinedFunctions(llvm::Module &M, llvm::StringRef Unit);
  /// Those that may be \p F, with whatever body.
  llvm::SmallVector<llvm::Function *, 1>
  candidates(const PlannedFunction &F) const;
  /// Those that are \p F.
  llvm::SmallVector<llvm::Function *, 1> find(const PlannedFunction &F);

private:
  static std::string placeOf(llvm::StringRef Linkage, llvm::StringRef File,
                             uint64_t Line);
  bool hasChecksum(llvm::Function &F, llvm::StringRef Checksum);

  std::string Unit;
  llvm::StringMap<llvm::Function *> ByName;
  llvm::StringMap<llvm::SmallVector<llvm::Function *, 1>> ByPlace;
  llvm::DenseMap<llvm::Function *, std::string> Checksums;
};

class PlanFunctions {
public:
  using Set = llvm::SmallVector<llvm::Function *, 1>;

  /// Finds the functions of \p Of in \p M, which \p Defined describes.
  PlanFunctions(llvm::Module &M, const Plan &Of, DefinedFunctions &Defined);

  /// Copies functions for their calls, as the plan says.
  void separate();
  /// To be called when another plan has copied functions, too.
  void addCopies(const PlanFunctions &Later);

  /// The functions of the module in which what the plan says of \p Number
  /// holds. For a copy that serves a call outside of the unit, that is the
  /// function that the call enters.
  const Set &of(uint64_t Number) const { return Sets[Number]; }
  /// True if the module defines the function that \p Number is, or a copy of.
  bool isHere(uint64_t Number) const {
    return !Found[Of.baseNumber(Number)].empty();
  }
  /// True if also the calls that it serves, if it is a copy, are here.
  bool isServedHere(uint64_t Number) const;
  /// The function that \p Number is, or is a copy of, if isServedHere().
  llvm::Function *servedHere(uint64_t Number) const {
    return isServedHere(Number) ? Found[Of.baseNumber(Number)].front()
                                : nullptr;
  }
  /// True if it is a copy that serves a call outside of the unit.
  bool isForOthers(uint64_t Number) const {
    return isHere(Number) && !isServedHere(Number);
  }
  /// True if that function is here with another body.
  bool differs(uint64_t Number) const {
    return Differing.contains(Of.baseNumber(Number));
  }

private:
  void separate(uint64_t Number, Copier &Round);
  void serve(uint64_t Number, llvm::ArrayRef<NumberedCall> Calls);

  const Plan &Of;
  std::vector<Set> Found; ///< by number, of no copy
  std::vector<Set> Sets;  ///< by number
  llvm::DenseSet<uint64_t> Differing;
  std::vector<llvm::SmallVector<uint64_t, 0>> Copies; ///< by number
  /// What separate() made, with what it was made from.
  std::vector<std::pair<llvm::Function *, llvm::Function *>> Made;
};

} // namespace tpc

#endif // TPC_PLANFUNCTIONS_H
