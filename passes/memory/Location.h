//===- Location.h - A variable, as a path from its root -------------------===//
#ifndef TPC_LOCATION_H
#define TPC_LOCATION_H

#include "memory/StepPath.h"

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Value.h"

#include <unordered_map>
#include <unordered_set>

namespace tpc {

/// A variable. If it has a Root (a global, a local, an allocation), the path
/// starts at the root. Otherwise it is a field of whatever object a pointer
/// leads to, and its path may be the end of a longer one.
struct Location {
  const llvm::Value *Root = nullptr;
  StepPath Path;
  /// If the root is an array: the element. If it is an allocation whose type is
  /// not known: the byte.
  Nth RootItem = {};

  /// The element at the end of the path.
  Nth item() const { return Path.empty() ? RootItem : Path.back().Item; }
  void setItem(Nth Item) {
    if (Path.empty())
      RootItem = Item;
    else
      Path.setItem(Item);
  }
  /// True if it is a single variable, not any element of an array.
  bool isOne() const {
    return RootItem.Number != Nth::Any &&
           llvm::none_of(
               Path, [](const Step &S) { return S.Item.Number == Nth::Any; });
  }
  /// Replaces the element at its end, or all elements on the path, by any
  /// element.
  void widen() {
    if (item().isNumber())
      setItem({Nth::Any});
  }
  void widenAll();

  bool isKnown() const { return Root || !Path.empty(); }
  bool isField() const { return !Path.empty() && Path.back().isField(); }
  /// True for the elements of a container.
  bool isElement() const {
    return !Path.empty() && Path.back().Type == Step::Element;
  }
  bool operator==(const Location &O) const {
    return Root == O.Root && RootItem == O.RootItem && Path == O.Path;
  }
  /// True if the two can be the same path from the same root.
  bool mayEqual(const Location &O) const {
    return Root == O.Root && RootItem.mayBe(O.RootItem) &&
           Path.mayEqual(O.Path);
  }
  /// mayEqual(), and the same elements of arrays.
  bool isSame(const Location &O) const {
    return Root == O.Root && RootItem == O.RootItem && Path.isSame(O.Path);
  }
  /// True if the two can be the same variable: a path without a root can be the
  /// end of a longer one.
  bool mayBe(const Location &O) const;
};

using Locations = llvm::SmallVector<Location, 1>;

/// A pointer to more places than this says nothing any more.
inline constexpr unsigned MaxLocations = 64;

/// Adds \p L to \p Out. Does not add a location that is unknown or exceeds the
/// limit; too many elements of one array become any element.
void addTo(Locations &Out, Location L);

/// Nothing iterates over a table with this hash, since its order depends on
/// addresses.
struct LocationHash {
  size_t operator()(const Location &L) const;
};
/// Maps exact locations; references to the values stay valid.
template <typename T>
using LocationMap = std::unordered_map<Location, T, LocationHash>;
using LocationSet = std::unordered_set<Location, LocationHash>;

/// A scalar that a load or store touches, and its bits in the register: several
/// scalars of an object can be passed as one number.
struct ScalarPart {
  Location Where;
  unsigned Low = 0, Size = 0; ///< bits; Size is 0 if there is only one scalar
};

} // namespace tpc

#endif // TPC_LOCATION_H
