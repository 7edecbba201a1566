//===- Texts.h - The texts that names are made of -------------------------===//
//
// The names of parameters and topics: constants, std::strings that are composed
// of constants, and the namespaces of node handles. A text is followed back
// from its use: inside the function to the last call that made or changed it,
// from an argument to the calls of its function, from a member to all writes of
// it. `<dynamic>` stands for a part that is not known.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TEXTS_H
#define TPC_TEXTS_H

#include "Rules.h"
#include "memory/VisibleWrites.h"

#include "llvm/ADT/SetVector.h"

namespace tpc {

/// Stands for a part of a name that is not constant.
inline constexpr char DynamicName[] = "<dynamic>";

/// True if a part of \p Name is not known.
inline bool isDynamic(llvm::StringRef Name) {
  return Name.contains(DynamicName);
}

/// \p Name in the namespace \p In, joined as ROS does.
std::string joinNames(llvm::StringRef In, llvm::StringRef Name);

class Texts {
public:
  /// What is known about the module's memory.
  struct MemoryView {
    PointsTo &Pointers;
    AccessIndex &Accesses;
    VisibleWrites &Writes;
    static MemoryView of(llvm::Module &M, llvm::ModuleAnalysisManager &AM) {
      return {AM.getResult<PointsToAnalysis>(M),
              AM.getResult<ClassObjectAccess>(M),
              AM.getResult<VisibleWritesAnalysis>(M)};
    }
  };

  /// Without \p Known, members are not followed.
  Texts(const RuleMatches &Rules, const CallGraphResult &Calls,
        std::optional<MemoryView> Known)
      : Rules(Rules), Calls(Calls), Memory(Known) {}

  /// The text of the std::string or char array that \p Pointer leads to when
  /// \p At runs.
  std::string textAt(const llvm::Value *Pointer, const llvm::Instruction &At);

  /// The name that \p Call, described by \p Row, passes, after the namespace of
  /// its handle if the row says so.
  std::string nameOf(const llvm::CallBase &Call, const Rule &Row);

  /// The namespace of the handle that the object of \p Call, described by
  /// \p Row, was made with; empty if no code in the link unit makes it.
  std::string namespaceOf(const llvm::CallBase &Call, const Rule &Row);

  /// The constant that \p V is. Also if \p V is an argument for which all calls
  /// pass the same constant, or a temporary that holds it. Null if there is
  /// none.
  const llvm::Constant *constantOf(const llvm::Value *V);

  /// The functions whose calls pass different texts that become part of a name.
  /// If they are copied for each call, each copy has its own name. Callers come
  /// before callees.
  llvm::ArrayRef<const llvm::Function *> shared() const {
    return Shared.getArrayRef();
  }

private:
  /// A text, and whether another call could make it different. None if it is
  /// only known to be the one that is being searched.
  struct Known {
    std::string Text;
    bool Varies = false;
    bool None = false;
    /// It is a name without a namespace before it.
    bool Absolute = false;
  };
  /// What a call does to an object that it gets.
  struct Effect {
    enum DoesTy { Keeps, Clears, Sets } Does;
    Known To = {};
  };
  enum class Kind { Text, Handle };
  using Places = llvm::DenseMap<const llvm::BasicBlock *, Known>;
  /// What is known from the name of a callee, which is demangled once.
  struct Callee {
    std::string Name;
    llvm::SmallVector<std::string, 4> Types; ///< as plainType gives them
    llvm::SmallVector<bool, 4> Constant;     ///< by written argument
    bool ConstMethod = false;
  };

  /// An unknown text. If no code in the link unit makes a handle, its namespace
  /// is left out: the name is then as in the read.
  static Known unknown(Kind K) { return {K == Kind::Text ? DynamicName : ""}; }
  Known knownAt(const llvm::Value *Pointer, const llvm::Instruction &At);
  Known find(const llvm::Value *Pointer, const llvm::Instruction &At, Kind K);
  Known follow(const llvm::Value *P, const llvm::Instruction &At, Kind K);
  Known above(const llvm::Value *Object, const llvm::Instruction *I,
              const llvm::BasicBlock *BB, Kind K, Places &Seen);
  Known local(const llvm::Value *Object, const llvm::Instruction &At, Kind K);
  Known ofArgument(const llvm::Argument &Arg, Kind K);
  Known ofResult(const llvm::CallBase &Call, Kind K);
  Known inMemory(const llvm::Value *Pointer, Kind K);
  Known ofMember(const Location &L, Kind K);
  Known loaded(const llvm::LoadInst &Load, Kind K);
  std::optional<Effect> effect(const llvm::CallBase &Call, unsigned N, Kind K);
  std::optional<Effect> ofString(const llvm::CallBase &Call,
                                 llvm::StringRef Method);
  Known joined(const llvm::CallBase &Call, const Rule &Row);
  Known piece(const llvm::CallBase &Call, unsigned N);
  Known returned(const llvm::CallBase &Call, Kind K);
  const Callee &calleeOf(const llvm::Function &F);
  Kind kindOf(const llvm::CallBase &Call, const llvm::Use &Argument);

  const RuleMatches &Rules;
  const CallGraphResult &Calls;
  std::optional<MemoryView> Memory;
  llvm::SmallSetVector<const llvm::Function *, 8> Shared;
  llvm::DenseMap<const llvm::Function *, std::unique_ptr<Callee>> Callees;
  /// Members, globals and arguments that are known so far, or being searched.
  llvm::SmallVector<std::pair<Location, Known>, 0> Members;
  llvm::DenseMap<const llvm::Argument *, Known> Arguments;
  unsigned Depth = 0, Steps = 0;
};

} // namespace tpc

#endif // TPC_TEXTS_H
