//===- Location.h - A variable, by the way to it --------------------------===//
#ifndef TPC_LOCATION_H
#define TPC_LOCATION_H

#include "llvm/ADT/ArrayRef.h"
#include "llvm/ADT/STLExtras.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Value.h"

#include <unordered_map>
#include <unordered_set>

namespace tpc {

/// Which element of an array is meant, if any. Elements of elements count
/// through: the first of the second row of three is number 3.
struct Nth {
  /// The whole array, as a pointer its beginning, or no array at all; and an
  /// element of which is not known which.
  static constexpr unsigned Whole = ~0U, Any = ~0U - 1;
  /// Elements behind these are not told apart from any.
  static constexpr unsigned Most = 64;

  unsigned Number = Whole;
  bool operator==(Nth O) const { return Number == O.Number; }
  bool isNumber() const { return Number < Any; }
  bool mayBe(Nth O) const {
    return Number == O.Number || !isNumber() || !O.isNumber();
  }
  /// So many elements on.
  Nth plus(int64_t By) const {
    int64_t To = (isNumber() ? Number : 0) + By;
    bool Known = Number != Any && To >= 0 && To < Most;
    return {Known ? static_cast<unsigned>(To) : Any};
  }
};

/// One step into a class: the number of its layout (see TypeNumbers), the
/// field's index, which class of the source it is (see DebugTypes), 0 where
/// that is not known, and of a field that is an array which element.
struct Step {
  /// Not classes: the step from a container to its elements, and one of so
  /// many bytes (the index) into an allocation whose type is not known.
  static constexpr unsigned Element = ~0U, Bytes = ~0U - 1;

  unsigned Type;
  unsigned Index;
  unsigned Class = 0;
  Nth Item = {};
  bool operator==(const Step &O) const {
    return Type == O.Type && Index == O.Index && Class == O.Class &&
           Item == O.Item;
  }
  /// True where the two can be the same step: of one the class may be unknown,
  /// or the element.
  bool mayEqual(const Step &O) const {
    return Type == O.Type && Index == O.Index &&
           (Class == O.Class || !Class || !O.Class) && Item.mayBe(O.Item);
  }
  /// mayEqual(), and of an array as much is meant.
  bool isSame(const Step &O) const { return mayEqual(O) && Item == O.Item; }
  bool isField() const { return Type < Bytes; }
};

/// A variable. With a Root (a global, a local, an allocation) the path is from
/// its beginning; without one it is a field of whatever object a pointer
/// leads to, and the path may be the end of a longer one.
struct Location {
  const llvm::Value *Root = nullptr;
  llvm::SmallVector<Step, 4> Path;
  Nth RootItem = {}; ///< of a root that is an array

  /// Of what is at the end of the path.
  Nth &item() { return Path.empty() ? RootItem : Path.back().Item; }
  Nth item() const { return Path.empty() ? RootItem : Path.back().Item; }
  /// True where it is one variable, not any of an array.
  bool isOne() const {
    return RootItem.Number != Nth::Any &&
           llvm::none_of(
               Path, [](const Step &S) { return S.Item.Number == Nth::Any; });
  }
  /// Means any element where it meant one: at its end, or on all of the way.
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
  /// True where the two can be the same path from the same root.
  bool mayEqual(const Location &O) const {
    return Root == O.Root && RootItem.mayBe(O.RootItem) &&
           mayEqual(Path, O.Path);
  }
  static bool mayEqual(llvm::ArrayRef<Step> A, llvm::ArrayRef<Step> B) {
    return llvm::equal(
        A, B, [](const Step &S, const Step &T) { return S.mayEqual(T); });
  }
  /// mayEqual(), and of arrays as much is meant.
  bool isSame(const Location &O) const {
    return Root == O.Root && RootItem == O.RootItem && areSame(Path, O.Path);
  }
  static bool areSame(llvm::ArrayRef<Step> A, llvm::ArrayRef<Step> B) {
    return llvm::equal(
        A, B, [](const Step &S, const Step &T) { return S.isSame(T); });
  }
  /// True where the two can be the same variable: without a root, a path can be
  /// the end of a longer one.
  bool mayBe(const Location &O) const;
};

/// True where \p Tail can be the end of \p Path.
bool endsWith(llvm::ArrayRef<Step> Path, llvm::ArrayRef<Step> Tail);

using Locations = llvm::SmallVector<Location, 1>;

/// More places than this for one pointer say nothing any more.
inline constexpr unsigned MaxLocations = 64;

/// Adds \p L to \p Out, to which it does not belong where it is not known, or
/// there are too many; of too many elements of one array it becomes any.
void addTo(Locations &Out, Location L);

/// Nothing iterates over a table by this hash: its order depends on addresses.
struct LocationHash {
  size_t operator()(const Location &L) const;
};
/// What is known of exactly these locations; a reference into it stays valid.
template <typename T>
using LocationMap = std::unordered_map<Location, T, LocationHash>;
using LocationSet = std::unordered_set<Location, LocationHash>;

/// A scalar that a load or store touches, and the bits of the register that are
/// it: an object of several scalars can be handed around as one number.
struct ScalarPart {
  Location Where;
  unsigned Low = 0, Size = 0; ///< bits; no size where there is but one scalar
};

} // namespace tpc

#endif // TPC_LOCATION_H
