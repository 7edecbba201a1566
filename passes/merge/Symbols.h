//===- Symbols.h - Which definition each unit takes -----------------------===//
//
// Of a symbol that several units define, the dynamic linker takes the first one
// in its global scope: the executable and what it needs. What a library brings
// that was opened with RTLD_LOCAL is in a scope of its own, which only the
// units in it look up, after the global one.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SYMBOLS_H
#define TPC_SYMBOLS_H

#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/Allocator.h"

#include <string>
#include <vector>

namespace tpc {

class Symbols {
public:
  struct Unit {
    llvm::StringRef Name;
    llvm::Module &Code; ///< what only the unit sees is local in it
  };

  /// \p Scopes are lists of the names of units: first the global scope, then
  /// that of each library that was opened. A unit in none is in the global one.
  Symbols(std::vector<Unit> Units,
          llvm::ArrayRef<std::vector<std::string>> Scopes);

  /// Makes what a unit takes from another one a declaration of that. Where
  /// several units keep their own definition, all but the first get a new name,
  /// and the functions are marked with LocalOf.
  ///
  /// Functions that are alike count once, as the one of the first unit: those
  /// of a header, with their variables.
  void choose();

  /// The names in the units of the definitions with a new name, by that.
  const llvm::StringMap<std::string> &renamed() const { return Renamed; }

private:
  using Numbers = llvm::SmallVector<unsigned, 1>;

  void findDefinitions();
  void setScopes(llvm::ArrayRef<std::vector<std::string>> Scopes);
  unsigned definerFor(unsigned Unit, const Numbers &Definers) const;
  bool isAlike(llvm::StringRef Name, const Numbers &Definers) const;
  void findSeparate();
  void separateUsers(llvm::StringRef Name, std::vector<llvm::StringRef> &Work);
  void choose(unsigned Unit);
  std::string newName(llvm::StringRef Name, unsigned Unit);

  std::vector<Unit> Units;
  std::vector<bool> IsGlobal;       ///< by unit
  std::vector<Numbers> SearchOrder; ///< by unit, behind the global scope
  /// The units whose definition of a name is taken, in their order.
  llvm::MapVector<llvm::StringRef, Numbers> Definitions;
  llvm::BumpPtrAllocator Memory;
  /// Those of which several are looked up, and of which each is kept.
  llvm::StringSet<> Apart, Separate;
  llvm::StringMap<std::string> NewNames; ///< by name and number of the unit
  llvm::StringMap<std::string> Renamed;
};

} // namespace tpc

#endif // TPC_SYMBOLS_H
