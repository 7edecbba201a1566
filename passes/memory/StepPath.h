//===- StepPath.h - The path from a root to a variable --------------------===//
//
// Equal paths are stored once, so that a path is as small as a pointer, equal
// paths are equal pointers, and most questions about two paths are answered
// without looking at their steps.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_STEPPATH_H
#define TPC_STEPPATH_H

#include "llvm/ADT/ArrayRef.h"
#include "llvm/ADT/STLExtras.h"

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
  /// Not a class: the step from a container to its elements.
  static constexpr unsigned Element = ~0U;

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
  bool isField() const { return Type != Element; }
};

class StepPath {
public:
  StepPath() = default;

  operator llvm::ArrayRef<Step>() const { return steps(); } // NOLINT
  llvm::ArrayRef<Step> steps() const {
    return N ? N->Steps : llvm::ArrayRef<Step>();
  }
  size_t size() const { return steps().size(); }
  bool empty() const { return !N; }
  auto begin() const { return steps().begin(); }
  auto end() const { return steps().end(); }
  const Step &operator[](size_t Index) const { return steps()[Index]; }
  const Step &back() const { return steps().back(); }

  void push_back(const Step &S) { N = inner(N, S); }
  void pop_back() { N = N->Outer; }
  Step pop_back_val() {
    Step Last = back();
    pop_back();
    return Last;
  }
  void append(llvm::ArrayRef<Step> More) {
    for (const Step &S : More)
      push_back(S);
  }
  void setItem(Nth Item) {
    Step Last = pop_back_val();
    Last.Item = Item;
    push_back(Last);
  }

  bool operator==(StepPath O) const { return N == O.N; }
  /// True if the two can be the same path.
  bool mayEqual(StepPath O) const {
    return N == O.N || (shape() == O.shape() && mayEqual(steps(), O.steps()));
  }
  /// mayEqual(), and the same elements of arrays.
  bool isSame(StepPath O) const {
    return N == O.N || (shape() == O.shape() && areSame(steps(), O.steps()));
  }
  static bool mayEqual(llvm::ArrayRef<Step> A, llvm::ArrayRef<Step> B) {
    return llvm::equal(
        A, B, [](const Step &S, const Step &T) { return S.mayEqual(T); });
  }
  static bool areSame(llvm::ArrayRef<Step> A, llvm::ArrayRef<Step> B) {
    return llvm::equal(
        A, B, [](const Step &S, const Step &T) { return S.isSame(T); });
  }
  /// The same for equal paths; only for tables that nothing iterates over.
  const void *address() const { return N; }

private:
  struct Node {
    llvm::ArrayRef<Step> Steps;
    const Node *Outer; ///< without the last step; null if that was the first
    unsigned Number;
    /// The same for all paths through the same fields, whatever their classes
    /// and elements.
    unsigned Shape;
  };
  class Store;

  static const Node *inner(const Node *Outer, const Step &S);
  unsigned shape() const { return N ? N->Shape : 0; }

  const Node *N = nullptr;
};

/// True if \p Tail can be the end of \p Path.
bool endsWith(llvm::ArrayRef<Step> Path, llvm::ArrayRef<Step> Tail);

} // namespace tpc

#endif // TPC_STEPPATH_H
