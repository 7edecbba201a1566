//===- Texts.h - What a name in the program is ----------------------------===//
//
// The names of parameters and topics: constants, what is put together of
// constants in std::strings, and the namespaces of node handles. A text is
// followed back from where it is used: in the function to the last call that
// made or changed it, an argument to the calls of its function, a member to
// all that write it. What cannot be told stands as `<dynamic>` in its place.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TEXTS_H
#define TPC_TEXTS_H

#include "Rules.h"
#include "memory/VisibleWrites.h"

#include "llvm/ADT/SetVector.h"

namespace tpc {

/// What stands for a part of a name that no constant gives.
inline constexpr char DynamicName[] = "<dynamic>";

/// True where a part of \p Name is not known.
inline bool isDynamic(llvm::StringRef Name) {
  return Name.contains(DynamicName);
}

/// \p Name in the namespace \p In, as ROS joins them.
std::string joinNames(llvm::StringRef In, llvm::StringRef Name);

class Texts {
public:
  /// What is known of the module's memory.
  struct MemoryView {
    PointsTo &Pointers;
    const AccessIndex &Accesses;
    VisibleWrites &Writes;
    static MemoryView of(llvm::Module &M, llvm::ModuleAnalysisManager &AM) {
      return {AM.getResult<PointsToAnalysis>(M),
              AM.getResult<ClassObjectAccess>(M),
              AM.getResult<VisibleWritesAnalysis>(M)};
    }
  };

  /// Without \p Known members are not looked into.
  Texts(const RuleMatches &Rules, const CallGraphResult &Calls,
        std::optional<MemoryView> Known)
      : Rules(Rules), Calls(Calls), Memory(Known) {}

  /// The text of the std::string or the characters that \p Pointer leads to
  /// where \p At runs.
  std::string textAt(const llvm::Value *Pointer, const llvm::Instruction &At);

  /// The name that \p Call, which \p Row describes, hands over; behind the
  /// namespace of its handle where the row says so.
  std::string nameOf(const llvm::CallBase &Call, const Rule &Row);

  /// The constant that \p V is, also where it is an argument and all calls
  /// hand over the same, or a temporary that holds it. Null where there is
  /// none.
  const llvm::Constant *constantOf(const llvm::Value *V);

  /// The functions whose calls hand them different texts of which a name is
  /// made: told apart, each call has its own. Callers stand before callees.
  llvm::ArrayRef<const llvm::Function *> shared() const {
    return Shared.getArrayRef();
  }

private:
  /// A text, and whether it would be another for another call. None where it
  /// is only known to be what is being asked for.
  struct Known {
    std::string Text;
    bool Varies = false;
    bool None = false;
    /// It is a name that no namespace comes before.
    bool Absolute = false;
  };
  /// What a call does to an object that it is handed.
  struct Effect {
    enum DoesTy { Keeps, Clears, Sets } Does;
    Known To = {};
  };
  enum class Kind { Text, Handle };
  using Places = llvm::DenseMap<const llvm::BasicBlock *, Known>;
  /// What is asked of a callee's name, which is demangled once.
  struct Callee {
    std::string Name;
    llvm::SmallVector<std::string, 4> Types; ///< plain
    llvm::SmallVector<bool, 4> Constant;     ///< by written argument
    bool ConstMethod = false;
  };

  /// What is not known of a text. Of a handle that nobody in the link unit
  /// makes the namespace is left out: the name is then as in the read.
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
  /// Members, globals and arguments that are known by now, or being asked for.
  llvm::SmallVector<std::pair<Location, Known>, 0> Members;
  llvm::DenseMap<const llvm::Argument *, Known> Arguments;
  unsigned Depth = 0, Steps = 0;
};

} // namespace tpc

#endif // TPC_TEXTS_H
