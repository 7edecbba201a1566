//===- TextCalls.cpp - What calls do to strings and handles ---------------===//
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// Names in ROS are shorter. A loop that appends to a text would make it ever
/// longer.
static cl::opt<unsigned>
    MaxLength("tpc-max-name-length", cl::Hidden, cl::init(256),
              cl::desc("Characters of a name of a parameter or topic"));

/// \p A followed by \p B; unknown parts on both sides of the seam become one.
static std::string concatenated(StringRef A, StringRef B) {
  if (A.ends_with(DynamicName))
    B.consume_front(DynamicName);
  return A.size() + B.size() > MaxLength ? DynamicName : (A + B).str();
}

std::string joinNames(StringRef In, StringRef Name) {
  std::string Joined;
  if (Name.starts_with("/") || Name.starts_with("~") || In.empty())
    Joined = Name.str();
  else if (Name.empty() || (In == DynamicName && Name == DynamicName))
    Joined = In.str();
  else if (In == "~")
    Joined = ("~" + Name).str();
  else
    Joined = (In.rtrim('/') + "/" + Name).str();
  // `~/a` is `~a`.
  if (StringRef(Joined).starts_with("~/"))
    Joined.erase(1, 1);
  return Joined;
}

const Texts::Callee &Texts::calleeOf(const Function &F) {
  std::unique_ptr<Callee> &C = Callees[&F];
  if (C)
    return *C;
  C = std::make_unique<Callee>();
  const StringRef Mangled = nameOfOriginal(F);
  C->Name = qualifiedName(Mangled);
  for (StringRef Type : parameterTypes(F)) {
    C->Types.push_back(plainType(Type));
    C->Constant.push_back(Type.ends_with(" const&"));
  }
  C->ConstMethod = StringRef(demangle(Mangled)).ends_with(") const");
  return *C;
}

/// The argument of \p Call, as written in the source, whose operand is \p N;
/// none for `this` and for the place of the result.
static std::optional<unsigned> writtenNumber(const CallBase &Call, unsigned N,
                                             size_t Written) {
  size_t Hidden = Call.arg_size() - std::min<size_t>(Call.arg_size(), Written);
  if (N < Hidden)
    return std::nullopt;
  return N - Hidden;
}

Texts::Kind Texts::kindOf(const CallBase &Call, const Use &Argument) {
  const Function *F = Call.getCalledFunction();
  if (!F)
    return Kind::Text;
  const Callee &C = calleeOf(*F);
  std::optional<unsigned> N =
      writtenNumber(Call, Call.getArgOperandNo(&Argument), C.Types.size());
  if (!N)
    return Kind::Handle;
  StringRef Type = C.Types[*N];
  return Type == "std::string" || Type.contains("char") ? Kind::Text
                                                        : Kind::Handle;
}

/// The text of argument \p N of \p Call: a string, a char array or a char.
Texts::Known Texts::piece(const CallBase &Call, unsigned N) {
  const Value *V = Call.getArgOperand(N);
  if (V->getType()->isPointerTy())
    return find(V, Call, Kind::Text);
  const auto *C = dyn_cast<ConstantInt>(V);
  if (!C || C->getBitWidth() != 8)
    return {DynamicName};
  return {std::string(1, static_cast<char>(C->getZExtValue()))};
}

/// What \p Row, of kind Naming, makes of the arguments of \p Call.
Texts::Known Texts::joined(const CallBase &Call, const Rule &Row) {
  Known All;
  for (const Rule::Part &P : Row.Parts) {
    Known One{P.Text};
    if (P.From != Rule::Part::Constant) {
      const Value *V = P.From == Rule::Part::Object
                           ? objectOf(Call, Row)
                           : argument(Call, Row, P.Number);
      const Use *U = find_if(Call.args(), [&](const Use &A) { return A == V; });
      One = V && V->getType()->isPointerTy() ? find(V, Call, kindOf(Call, *U))
                                             : Known{DynamicName};
    }
    All.Varies |= One.Varies;
    StringRef Text = One.None ? StringRef(DynamicName) : StringRef(One.Text);
    All.Text = joinNames(One.Absolute ? "" : All.Text, Text);
  }
  All.Absolute = Row.Absolute;
  return All;
}

/// What \p Method of std::string does to its object; none if that is not known.
std::optional<Texts::Effect> Texts::ofString(const CallBase &Call,
                                             StringRef Method) {
  const Callee &C = calleeOf(*Call.getCalledFunction());
  auto IsText = [&](unsigned N) {
    return C.Types[N] == "std::string" || C.Types[N] == "char const*" ||
           C.Types[N] == "char";
  };
  bool One = C.Types.size() == 1 && IsText(0);
  if (Method == "basic_string") {
    if (C.Types.empty() || C.Types[0] == "std::allocator")
      return Effect{Effect::Clears};
    if (One ||
        (C.Types.size() == 2 && IsText(0) && C.Types[1] == "std::allocator"))
      return Effect{Effect::Sets, piece(Call, 1)};
    return std::nullopt;
  }
  if ((Method == "operator=" || Method == "assign") && One)
    return Effect{Effect::Sets, piece(Call, 1)};
  if ((Method == "operator+=" || Method == "append" || Method == "push_back") &&
      One) {
    Known Old = find(Call.getArgOperand(0), Call, Kind::Text);
    Known New = piece(Call, 1);
    if (Old.None || New.None)
      return std::nullopt;
    return Effect{Effect::Sets,
                  {concatenated(Old.Text, New.Text), Old.Varies || New.Varies,
                   /*None=*/false, Old.Absolute}};
  }
  if (Method == "clear")
    return Effect{Effect::Clears};
  bool OnlyLooks = Method == "operator[]" || Method == "at" ||
                   Method == "front" || Method == "back";
  if (C.ConstMethod || Method == "~basic_string" || Method == "reserve" ||
      (OnlyLooks &&
       all_of(Call.users(), [](const User *U) { return isa<LoadInst>(U); })))
    return Effect{Effect::Keeps};
  return std::nullopt;
}

/// What \p Call does to the object that it gets as operand \p N; none if that
/// is not known.
std::optional<Texts::Effect> Texts::effect(const CallBase &Call, unsigned N,
                                           Kind K) {
  const Function *F = Call.getCalledFunction();
  if (!F)
    return K == Kind::Handle || Call.onlyReadsMemory(N)
               ? std::optional(Effect{Effect::Keeps})
               : std::nullopt;
  const Value *Object = Call.getArgOperand(N);
  bool Made = N == 0 && Call.hasStructRetAttr();
  if (const Rule *Row = Rules.match(Call); Row && Row->Kind == Rule::Naming) {
    const Value *Target = Row->Target == Rule::ToObject ? objectOf(Call, *Row)
                          : Row->Target == Rule::ToArgument
                              ? argument(Call, *Row, Row->TargetArgument)
                          : Call.hasStructRetAttr() ? Call.getArgOperand(0)
                                                    : nullptr;
    if (Target == Object) {
      Known To = joined(Call, *Row);
      return Effect{To.Text.empty() ? Effect::Clears : Effect::Sets, To};
    }
  }
  const Callee &C = calleeOf(*F);
  std::optional<unsigned> Written = writtenNumber(Call, N, C.Types.size());
  StringRef Method = C.Name;
  if (!Written && !Made && Method.consume_front("std::__cxx11::basic_string::"))
    return ofString(Call, Method);
  if (Made && C.Name == "std::operator+" && C.Types.size() == 2) {
    Known L = piece(Call, 1), R = piece(Call, 2);
    if (L.None || R.None)
      return std::nullopt;
    return Effect{Effect::Sets,
                  {concatenated(L.Text, R.Text), L.Varies || R.Varies,
                   /*None=*/false, L.Absolute}};
  }
  if (Made && C.Name == "std::__cxx11::to_string")
    if (const auto *Number = dyn_cast<ConstantInt>(Call.getArgOperand(1)))
      return Effect{Effect::Sets, {std::to_string(Number->getSExtValue())}};
  if (Made && !Calls.callees(Call).empty())
    return Effect{Effect::Sets, returned(Call, K)};
  if (Made)
    return Effect{Effect::Sets, unknown(K)};
  // A global is passed to a function that destroys it at exit.
  if (K == Kind::Handle || Call.onlyReadsMemory(N) ||
      F->getName() == "__cxa_atexit" ||
      (Written ? C.Constant[*Written] : C.ConstMethod))
    return Effect{Effect::Keeps};
  return std::nullopt;
}

} // namespace tpc
