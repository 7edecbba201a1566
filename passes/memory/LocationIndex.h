//===- LocationIndex.h - Finds things by location -------------------------===//
//
// Three ways to find the locations that can be the same memory (see Aliases.h)
// without comparing all of them: at a location, around it and in it. Each
// returns some numbers too many, because it compares only the ends of paths;
// the caller checks each with Aliases. The numbers come in ascending order for
// each key.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOCATIONINDEX_H
#define TPC_LOCATIONINDEX_H

#include "memory/Aliases.h"

#include "llvm/ADT/DenseMap.h"

namespace tpc {

/// Calls \p F with the numbers that \p In has for \p Key.
template <typename Map, typename Fn>
void eachOf(const Map &In, const typename Map::key_type &Key, Fn F) {
  if (auto It = In.find(Key); It != In.end())
    llvm::for_each(It->second, F);
}

/// Numbers by location.
class LocationIndex {
public:
  explicit LocationIndex(const Aliases &Alias) : Alias(Alias) {}

  /// The last step of a location, or its root if there is no step. The number
  /// of a class is shifted so that it is never the address of a root.
  using Slot = std::pair<uintptr_t, unsigned>;
  static Slot slotOf(const Location &L) { return slotOf(L.Root, L.Path); }

  void add(unsigned N, const Location &L) { add(N, L, L.Path.size()); }
  /// The same for the object that the first \p Steps of \p L lead to.
  void add(unsigned N, const Location &L, size_t Steps);

  /// Calls \p F with the numbers of locations with the same last step and root
  /// as \p L; the root may be null.
  template <typename Fn> void eachWithRootOf(const Location &L, Fn F) const {
    eachOf(Exact, std::pair(slotOf(L), L.Root), F);
  }
  /// Calls \p F with the numbers of locations that can be \p L.
  template <typename Fn> void eachAt(const Location &L, Fn F) const {
    eachAt(L, L.Path.size(), F);
  }
  /// Calls \p F with the numbers of locations that can be \p L or an object on
  /// its path.
  template <typename Fn> void eachAround(const Location &L, Fn F) const;

private:
  static Slot slotOf(const llvm::Value *Root, llvm::ArrayRef<Step> Path);
  template <typename Fn>
  void eachAt(const Location &L, size_t Steps, Fn F) const;

  const Aliases &Alias;
  llvm::DenseMap<std::pair<Slot, const llvm::Value *>,
                 llvm::SmallVector<unsigned, 2>>
      Exact; ///< by slot and root, which may be null
  /// Locations with a root that pointers without a known root can reach.
  llvm::DenseMap<Slot, llvm::SmallVector<unsigned, 2>> Rooted;
};

/// Numbers of objects.
class ObjectIndex {
public:
  ObjectIndex(const Aliases &Alias, LocationTypes &Types)
      : Alias(Alias), Types(Types), ByLocation(Alias) {}

  void add(unsigned N, const Location &Object);
  /// Calls \p F with the numbers of the objects that \p L can be, or be in.
  template <typename Fn> void eachAround(const Location &L, Fn F) const {
    eachOnPath(L, F);
    if (auto Class = classAround(L))
      eachWith(*Class, F);
  }
  /// The same without the objects that it can be in only because they have its
  /// class.
  template <typename Fn> void eachOnPath(const Location &L, Fn F) const {
    ByLocation.eachAround(L, F);
  }
  /// Calls \p F with the numbers of the objects that are of the class number
  /// \p Class or have a part of it; none is too many.
  template <typename Fn> void eachWith(unsigned Class, Fn F) const {
    eachOf(ByClass, Class, F);
  }
  /// The class of whatever object \p L is in; none if \p L has a root.
  static std::optional<unsigned> classAround(const Location &L) {
    if (L.Root || L.Path.empty())
      return std::nullopt;
    return L.Path[0].Type;
  }

private:
  const Aliases &Alias;
  LocationTypes &Types;
  LocationIndex ByLocation;
  /// By the classes inside the object.
  llvm::DenseMap<unsigned, llvm::SmallVector<unsigned, 4>> ByClass;
};

/// Numbers of variables by all objects that contain them.
class PartIndex {
public:
  PartIndex(const Aliases &Alias, LocationTypes &Types)
      : Alias(Alias), Types(Types), ByObject(Alias) {}

  void add(unsigned N, const Location &L);
  /// Calls \p F with the numbers of locations that can be \p Object, or in it.
  template <typename Fn> void eachIn(const Location &Object, Fn F) const {
    ByObject.eachAt(Object, F);
    if (!Alias.isReachable(Object))
      return;
    llvm::SmallSetVector<unsigned, 8> Classes;
    Types.addClassesIn(Types.typeAt(Object), Classes);
    for (unsigned Class : Classes)
      eachOf(ByClass, Class, F);
  }

private:
  const Aliases &Alias;
  LocationTypes &Types;
  LocationIndex ByObject;
  /// Without a root: by the class at the beginning of the path.
  llvm::DenseMap<unsigned, llvm::SmallVector<unsigned, 4>> ByClass;
};

template <typename Fn>
void LocationIndex::eachAt(const Location &L, size_t Steps, Fn F) const {
  Slot Here = slotOf(L.Root, L.Path.steps().take_front(Steps));
  eachOf(Exact, std::pair(Here, L.Root), F);
  if (!L.Root)
    eachOf(Rooted, Here, F);
  else if (Steps && Alias.isReachable(L))
    eachOf(Exact, std::pair(Here, static_cast<const llvm::Value *>(nullptr)),
           F);
}

template <typename Fn>
void LocationIndex::eachAround(const Location &L, Fn F) const {
  for (size_t Steps = L.Root ? 0 : 1; Steps <= L.Path.size(); ++Steps)
    eachAt(L, Steps, F);
}

} // namespace tpc

#endif // TPC_LOCATIONINDEX_H
