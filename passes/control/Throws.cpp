//===- Throws.cpp ---------------------------------------------------------===//
#include "control/Throws.h"

#include "Options.h"
#include "support/Functions.h"

#include "llvm/IR/Constants.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

AnalysisKey Throws::Key;

/// Each type is propagated through all callers. Beyond the limit a call counts
/// as throwing any type.
static cl::opt<unsigned> MaxTypes(
    "tpc-max-thrown-types", cl::Hidden, cl::init(4),
    cl::desc("Types of exceptions that are distinguished at one call"));

/// Exception classes have few bases; a damaged table might contain a cycle.
static cl::opt<unsigned> MaxBases(
    "tpc-max-exception-bases", cl::Hidden, cl::init(32),
    cl::desc("Base classes of an exception that are compared with a handler"));

//===----------------------------------------------------------------------===//
// What a handler catches
//===----------------------------------------------------------------------===//

/// The mangled name of a type, `St12out_of_range`.
static StringRef typeName(const GlobalVariable &Type) {
  StringRef Name = Type.getName();
  Name.consume_front("_ZTI");
  return Name;
}

static bool isStandard(StringRef Type) {
  return Type.starts_with("St") || Type.starts_with("NSt");
}

/// The same for types of the standard library, whose bases are not in the link
/// unit: [std.exceptions].
static std::optional<bool> isStandardBase(StringRef Thrown, StringRef Handler) {
  if (Handler == "St9exception")
    return true;
  static constexpr StringRef Logic[] = {"St12domain_error", "St12length_error",
                                        "St12out_of_range",
                                        "St16invalid_argument"};
  static constexpr StringRef Runtime[] = {"St11range_error", "St12system_error",
                                          "St14overflow_error",
                                          "St15underflow_error"};
  if (is_contained(Logic, Thrown))
    return Handler == "St11logic_error";
  if (is_contained(Runtime, Thrown))
    return Handler == "St13runtime_error";
  if (Thrown == "St11logic_error" || Thrown == "St13runtime_error" ||
      !isStandard(Handler))
    return false;
  return std::nullopt;
}

std::optional<bool> isTakenBy(ThrownType Thrown, const Constant *Handler) {
  if (isa<ConstantPointerNull>(Handler))
    return true;
  const auto *Wanted = dyn_cast<GlobalVariable>(Handler);
  if (!Thrown || !Wanted)
    return std::nullopt;
  SmallSetVector<const GlobalVariable *, 4> Work;
  Work.insert(Thrown);
  bool Sure = true;
  for (unsigned N = 0; N < Work.size(); ++N) {
    const GlobalVariable *Type = Work[N];
    StringRef Name = typeName(*Type);
    if (Type == Wanted)
      return true;
    if (N > MaxBases)
      return std::nullopt;
    if (Name.size() == 1) // int, double and so on: no other type catches them
      continue;
    if (Type->hasInitializer()) {
      // An object has the bases of its type after its table and its name. A
      // pointer has what it points to, and converts in more ways.
      if (Name.starts_with("P"))
        return std::nullopt;
      for (const Use &Base : Type->getInitializer()->operands())
        if (const auto *G = dyn_cast<GlobalVariable>(Base.get());
            G && G->getName().starts_with("_ZTI"))
          Work.insert(G);
      continue;
    }
    std::optional<bool> Known;
    if (isStandard(Name))
      Known = isStandardBase(Name, typeName(*Wanted));
    if (Known == true)
      return true;
    Sure &= Known.has_value();
  }
  return Sure ? std::optional<bool>(false) : std::nullopt;
}

/// True if an exception of \p Type thrown by \p Call is not caught in its
/// function.
static bool escapes(const CallBase &Call, ThrownType Type) {
  const auto *Invoke = dyn_cast<InvokeInst>(&Call);
  if (!Invoke)
    return true;
  const LandingPadInst &Pad = *Invoke->getLandingPadInst();
  for (unsigned N = 0; N < Pad.getNumClauses(); ++N)
    if (Pad.isCatch(N) && isTakenBy(Type, Pad.getClause(N)) == true)
      return false;
  return true;
}

//===----------------------------------------------------------------------===//
// Which calls throw
//===----------------------------------------------------------------------===//

bool isThrow(const Instruction &I) {
  const auto *Call = dyn_cast<CallBase>(&I);
  const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
  return Callee && (Callee->getName() == "__cxa_throw" ||
                    Callee->getName() == "__cxa_rethrow");
}

ArrayRef<ThrownType> ThrowsResult::thrownBy(const Instruction &I) const {
  auto It = ByCall.find(&I);
  return It == ByCall.end() ? ArrayRef<ThrownType>() : ArrayRef(It->second);
}

ArrayRef<CallBase *> ThrowsResult::leaving(const Function *F) const {
  auto It = Leaving.find(F);
  return It == Leaving.end() ? ArrayRef<CallBase *>()
                             : It->second.getArrayRef();
}

bool ThrowsResult::leaves(const CallBase &Call) const {
  auto It = Leaving.find(Call.getFunction());
  return It != Leaving.end() &&
         It->second.contains(const_cast<CallBase *>(&Call));
}

/// Adds \p Type. If there are too many types, they are all replaced by null.
/// True if it is new.
static bool addType(ThrowsResult::Types &To, ThrownType &Type) {
  if (is_contained(To, Type) || is_contained(To, nullptr))
    return false;
  if (To.size() == MaxTypes)
    Type = nullptr;
  if (!Type)
    To.assign(1, nullptr);
  else
    To.push_back(Type);
  return true;
}

Throws::Result Throws::run(Module &M, ModuleAnalysisManager &AM) {
  ThrowsResult R;
  if (!M.getFunction("__cxa_throw") && !M.getFunction("__cxa_rethrow"))
    return R;
  const auto &Calls = AM.getResult<SimpleCallGraph>(M);
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  UserSources Sources(Opts);
  DenseMap<const Function *, ThrowsResult::Types> Out;
  SmallVector<std::pair<CallBase *, ThrownType>, 0> Work;
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F))
      if (isThrow(I) && Sources.has(I.getDebugLoc())) {
        auto &Call = cast<CallBase>(I);
        Work.emplace_back(
            &Call, Call.arg_size() < 2
                       ? nullptr
                       : dyn_cast<GlobalVariable>(Call.getArgOperand(1)));
      }
  // From each throw up through the calls, one type at a time.
  for (size_t N = 0; N < Work.size(); ++N) {
    auto [Call, Type] = Work[N];
    if (Call->doesNotThrow() || !addType(R.ByCall[Call], Type) ||
        !escapes(*Call, Type))
      continue;
    Function *F = Call->getFunction();
    if (F->doesNotThrow())
      continue;
    R.Leaving[F].insert(Call);
    if (addType(Out[F], Type))
      for (CallBase *Caller : Calls.callers(F))
        if (is_contained(Calls.callees(*Caller), F))
          Work.emplace_back(Caller, Type);
  }
  return R;
}

} // namespace tpc
