//===- Location.h - A variable, as a path from its root -------------------===//
#ifndef TPC_LOCATION_H
#define TPC_LOCATION_H

#include "llvm/ADT/ArrayRef.h"
#include "llvm/ADT/STLExtras.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Value.h"

#include <unordered_map>
#include <unordered_set>

namespace tpc {

/// Which element of an array is meant, if any. The elements of nested arrays
/// are counted through: the first of the second row of three is number 3.
struct Nth {
  /// Whole is the whole array, a pointer to its beginning, or no array at all.
  /// Any is an element with an unknown number.
  static constexpr unsigned Whole = ~0U, Any = ~0U - 1;
  /// Elements with higher numbers count as Any.
  static constexpr unsigned Most = 64;

  unsigned Number = Whole;
  bool operator==(Nth O) const { return Number == O.Number; }
  bool isNumber() const { return Number < Any; }
  bool mayBe(Nth O) const {
    return Number == O.Number || !isNumber() || !O.isNumber();
  }
  /// The element \p By elements further on.
  Nth plus(int64_t By) const {
    int64_t To = (isNumber() ? Number : 0) + By;
    bool Known = Number != Any && To >= 0 && To < Most;
    return {Known ? static_cast<unsigned>(To) : Any};
  }
};

/// One step into a class: the number of its layout (see TypeNumbers), the index
/// of the field, the class of the source (see DebugTypes; 0 if it is not known)
/// and, if the field is an array, the element.
struct Step {
  /// Not classes: the step from a container to its elements, and a step by a
  /// number of bytes (the index) into an allocation of unknown type.
  static constexpr unsigned Element = ~0U, Bytes = ~0U - 1;

  unsigned Type;
  unsigned Index;
  unsigned Class = 0;
  Nth Item = {};
  bool operator==(const Step &O) const {
    return Type == O.Type && Index == O.Index && Class == O.Class &&
           Item == O.Item;
  }
  /// True if the two can be the same step: the class or the element of one may
  /// be unknown.
  bool mayEqual(const Step &O) const {
    return Type == O.Type && Index == O.Index &&
           (Class == O.Class || !Class || !O.Class) && Item.mayBe(O.Item);
  }
  /// mayEqual(), and the same elements of an array.
  bool isSame(const Step &O) const { return mayEqual(O) && Item == O.Item; }
  bool isField() const { return Type < Bytes; }
};

/// A variable. If it has a Root (a global, a local, an allocation), the path
/// starts at the root. Otherwise it is a field of whatever object a pointer
/// leads to, and its path may be the end of a longer one.
struct Location {
  const llvm::Value *Root = nullptr;
  llvm::SmallVector<Step, 4> Path;
  Nth RootItem = {}; ///< if the root is an array

  /// The element at the end of the path.
  Nth &item() { return Path.empty() ? RootItem : Path.back().Item; }
  Nth item() const { return Path.empty() ? RootItem : Path.back().Item; }
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
      item() = {Nth::Any};
  }
  void widenAll() {
    if (RootItem.isNumber())
      RootItem = {Nth::Any};
    for (Step &S : Path)
      if (S.Item.isNumber())
        S.Item = {Nth::Any};
  }

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
           mayEqual(Path, O.Path);
  }
  static bool mayEqual(llvm::ArrayRef<Step> A, llvm::ArrayRef<Step> B) {
    return llvm::equal(
        A, B, [](const Step &S, const Step &T) { return S.mayEqual(T); });
  }
  /// mayEqual(), and the same elements of arrays.
  bool isSame(const Location &O) const {
    return Root == O.Root && RootItem == O.RootItem && areSame(Path, O.Path);
  }
  static bool areSame(llvm::ArrayRef<Step> A, llvm::ArrayRef<Step> B) {
    return llvm::equal(
        A, B, [](const Step &S, const Step &T) { return S.isSame(T); });
  }
  /// True if the two can be the same variable: a path without a root can be the
  /// end of a longer one.
  bool mayBe(const Location &O) const;
};

/// True if \p Tail can be the end of \p Path.
bool endsWith(llvm::ArrayRef<Step> Path, llvm::ArrayRef<Step> Tail);

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
