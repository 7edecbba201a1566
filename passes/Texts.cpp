//===- Texts.cpp ----------------------------------------------------------===//
#include "Texts.h"

#include "Names.h"

#include "llvm/ADT/ScopeExit.h"
#include "llvm/ADT/StringExtras.h"
#include "llvm/Analysis/ConstantFolding.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// Steps from one object to another, and blocks of one function, beyond which
/// a text is not followed.
static constexpr unsigned MaxDepth = 64, MaxBlocks = 2000;

//===----------------------------------------------------------------------===//
// Texts
//===----------------------------------------------------------------------===//

/// \p A and \p B in one; what is not known on both sides of the seam is one
/// unknown part.
static std::string concatenated(StringRef A, StringRef B) {
  if (A.ends_with(DynamicName))
    B.consume_front(DynamicName);
  return (A + B).str();
}

/// \p Name in the namespace \p In, as ROS joins them.
static std::string joinNames(StringRef In, StringRef Name) {
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

/// What is not known of a text. Of a handle that nobody in the link unit makes
/// the namespace is left out: the name is then as it is given in the read.
template <typename Known, typename Kind> static Known unknown(Kind K) {
  return {K == Kind::Text ? DynamicName : ""};
}

/// \p Into, of which \p Any says whether it is anything yet, or \p New: what
/// two ways give differently is not known.
template <typename Known> static void merge(Known &Into, const Known &New) {
  if (New.None)
    return;
  if (Into.None) {
    Into = New;
    return;
  }
  Into.Varies |= New.Varies;
  if (Into.Text != New.Text)
    Into.Text = DynamicName;
}

//===----------------------------------------------------------------------===//
// What a call does to an object
//===----------------------------------------------------------------------===//

const Texts::Callee &Texts::calleeOf(const Function &F) {
  std::unique_ptr<Callee> &C = Callees[&F];
  if (C)
    return *C;
  C = std::make_unique<Callee>();
  C->Name = qualifiedName(F.getName());
  for (StringRef Type : parameterTypes(F)) {
    C->Types.push_back(plainType(Type));
    C->Constant.push_back(Type.ends_with(" const&"));
  }
  C->ConstMethod = StringRef(demangle(F.getName())).ends_with(") const");
  return *C;
}

/// The number of the written argument that \p N of \p Call is; none for `this`
/// and the place of the result.
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

/// The text of argument \p N of \p Call, a string, characters or a character.
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
    All.Text = joinNames(All.Text, One.None ? DynamicName : One.Text);
  }
  return All;
}

/// What \p Method of std::string does to its object; none where that is not
/// known.
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
                  {concatenated(Old.Text, New.Text), Old.Varies || New.Varies}};
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

/// What \p Call does to the object that it gets as operand \p N; none where
/// that is not known.
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
                  {concatenated(L.Text, R.Text), L.Varies || R.Varies}};
  }
  if (Made && C.Name == "std::__cxx11::to_string")
    if (const auto *Number = dyn_cast<ConstantInt>(Call.getArgOperand(1)))
      return Effect{Effect::Sets, {std::to_string(Number->getSExtValue())}};
  if (Made && !Calls.callees(Call).empty())
    return Effect{Effect::Sets, returned(Call, K)};
  if (Made)
    return Effect{Effect::Sets, unknown<Known>(K)};
  // A global is handed over to be destroyed at the end.
  if (K == Kind::Handle || Call.onlyReadsMemory(N) ||
      F->getName() == "__cxa_atexit" ||
      (Written ? C.Constant[*Written] : C.ConstMethod))
    return Effect{Effect::Keeps};
  return std::nullopt;
}

//===----------------------------------------------------------------------===//
// The way back
//===----------------------------------------------------------------------===//

/// What \p Object, which the function itself makes or gets, holds above \p I
/// in \p BB; None where nothing on the way sets it.
Texts::Known Texts::above(const Value *Object, const Instruction *I,
                          const BasicBlock *BB, Kind K, Places &Seen) {
  while (true) {
    for (; I; I = I->getPrevNode()) {
      const auto *Call = dyn_cast<CallBase>(I);
      if (!Call || isa<IntrinsicInst>(Call))
        continue;
      for (const auto &[N, Arg] : enumerate(Call->args())) {
        if (Arg != Object)
          continue;
        std::optional<Effect> E = effect(*Call, N, K);
        if (!E)
          return unknown<Known>(K);
        if (E->Does == Effect::Clears)
          return {""};
        if (E->Does == Effect::Sets)
          return E->To;
      }
    }
    if (Seen.size() > MaxBlocks)
      return unknown<Known>(K);
    const BasicBlock *Only = BB->getSinglePredecessor();
    if (!Only)
      break;
    // A block that is asked for again on a way round a loop adds nothing.
    if (!Seen.try_emplace(Only, Known{"", false, true}).second)
      return Seen[Only];
    BB = Only;
    I = &BB->back();
  }
  Known All{"", false, true};
  for (const BasicBlock *Pred : predecessors(BB)) {
    auto [It, New] = Seen.try_emplace(Pred, Known{"", false, true});
    if (New) {
      Known Found = above(Object, &Pred->back(), Pred, K, Seen);
      Seen[Pred] = Found;
    }
    merge(All, Seen[Pred]);
  }
  return All;
}

Texts::Known Texts::local(const Value *Object, const Instruction &At, Kind K) {
  Places Seen;
  return above(Object, At.getPrevNode(), At.getParent(), K, Seen);
}

/// What the calls of its function hand over as \p Arg.
Texts::Known Texts::ofArgument(const Argument &Arg, Kind K) {
  auto [It, New] = Arguments.try_emplace(&Arg, Known{"", false, true});
  if (!New)
    return It->second;
  const Function *F = Arg.getParent();
  Known All{"", false, true};
  bool Differ = false;
  for (const CallBase *Call : Calls.callers(F)) {
    // A callback's arguments come from elsewhere.
    Known One =
        Call->getCalledFunction() == F && Arg.getArgNo() < Call->arg_size()
            ? find(Call->getArgOperand(Arg.getArgNo()), *Call, K)
            : unknown<Known>(K);
    if (One.None)
      continue;
    Differ |= !All.None && All.Text != One.Text;
    merge(All, One);
  }
  if (All.None)
    All = unknown<Known>(K);
  All.Varies |= Differ;
  if (All.Varies)
    Shared.insert(F);
  return Arguments[&Arg] = All;
}

/// What the function that \p Call enters returns.
Texts::Known Texts::returned(const CallBase &Call, Kind K) {
  Known All{"", false, true};
  for (const Function *F : Calls.callees(Call))
    for (const BasicBlock &BB : *F) {
      const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator());
      if (!Return)
        continue;
      Known One = Call.hasStructRetAttr()
                      ? local(F->getArg(0), *Return, K)
                      : find(Return->getReturnValue(), *Return, K);
      merge(All, One.None ? unknown<Known>(K) : One);
    }
  return All.None ? unknown<Known>(K) : All;
}

/// What the pointer that \p Call returns leads to.
Texts::Known Texts::ofResult(const CallBase &Call, Kind K) {
  const Function *F = Call.getCalledFunction();
  if (!F)
    return unknown<Known>(K);
  if (const Rule *Row = Rules.match(Call); Row && Row->Kind == Rule::Naming)
    return joined(Call, *Row);
  StringRef Name = calleeOf(*F).Name;
  if (Name.consume_front("std::__cxx11::basic_string::")) {
    if (Name == "c_str" || Name == "data")
      return find(Call.getArgOperand(0), Call, K);
    // What changes a string returns it.
    std::optional<Effect> E = ofString(Call, Name);
    return E && E->Does == Effect::Sets ? E->To : unknown<Known>(K);
  }
  if (!Calls.callees(Call).empty())
    return returned(Call, K);
  // A new object is what its constructor makes of it.
  Known All{"", false, true};
  for (const Use &U : Call.uses()) {
    const auto *User = dyn_cast<CallBase>(U.getUser());
    if (!User || !User->isArgOperand(&U))
      continue;
    std::optional<Effect> E = effect(*User, User->getArgOperandNo(&U), K);
    if (E && E->Does == Effect::Sets)
      merge(All, E->To);
  }
  return All.None ? unknown<Known>(K) : All;
}

/// What everything that writes the member or global \p L gives it. That it was
/// empty before is not meant.
Texts::Known Texts::ofMember(const Location &L, Kind K) {
  if (auto *It = find_if(Members, [&](auto &M) { return M.first == L; });
      It != Members.end())
    return It->second;
  size_t Mine = Members.size();
  Members.push_back({L, Known{"", false, true}});
  Known All{"", false, true};
  bool Cleared = false;
  for (const Instruction *W : Access->writesInto(L)) {
    const auto *Call = dyn_cast<CallBase>(W);
    if (!Call || isa<IntrinsicInst>(Call))
      continue;
    bool Entered = !Calls.callees(*Call).empty();
    for (const auto &[N, Arg] : enumerate(Call->args())) {
      // What a function that is looked into does, its own calls tell.
      if (!Arg->getType()->isPointerTy() ||
          (Entered && !(N == 0 && Call->hasStructRetAttr())) ||
          none_of(Access->resolve(Arg, false),
                  [&](const Location &O) { return O.mayBe(L); }))
        continue;
      std::optional<Effect> E = effect(*Call, N, K);
      if (!E)
        merge(All, {DynamicName});
      else if (E->Does == Effect::Sets)
        merge(All, E->To);
      else
        Cleared |= E->Does == Effect::Clears;
    }
  }
  if (All.None)
    All = Cleared ? Known{""} : unknown<Known>(K);
  return Members[Mine].second = All;
}

Texts::Known Texts::inMemory(const Value *Pointer, Kind K) {
  if (!Access)
    return unknown<Known>(K);
  Known All{"", false, true};
  bool Any = false;
  for (const Location &L : Access->resolve(Pointer, false)) {
    Any = true;
    merge(All, ofMember(L, K));
  }
  return Any ? All : unknown<Known>(K);
}

/// What the pointer that \p Load gives leads to.
Texts::Known Texts::loaded(const LoadInst &Load, Kind K) {
  const DataLayout &Layout = Load.getModule()->getDataLayout();
  if (auto *C = dyn_cast<Constant>(Load.getPointerOperand()))
    if (Constant *Folded = ConstantFoldLoadFromConstPtr(
            const_cast<Constant *>(C), Load.getType(), Layout))
      return find(Folded, Load, K);
  if (!Access)
    return unknown<Known>(K);
  Known All{"", false, true};
  for (const Instruction *W : Access->definitionsOf(Load)) {
    const auto *Store = dyn_cast<StoreInst>(W);
    merge(All, Store ? find(Store->getValueOperand(), *Store, K)
                     : Known{DynamicName});
  }
  const auto *Global = dyn_cast<GlobalVariable>(Load.getPointerOperand());
  if (All.None && Global && Global->hasLocalLinkage() &&
      Global->hasInitializer())
    return find(Global->getInitializer(), Load, K);
  return All.None ? unknown<Known>(K) : All;
}

Texts::Known Texts::follow(const Value *P, const Instruction &At, Kind K) {
  if (const auto *Arg = dyn_cast<Argument>(P)) {
    Known Here = local(Arg, At, K);
    return Here.None ? ofArgument(*Arg, K) : Here;
  }
  if (isa<AllocaInst>(P)) {
    Known Here = local(P, At, K);
    return Here.None ? inMemory(P, K) : Here;
  }
  if (const auto *Call = dyn_cast<CallBase>(P))
    return ofResult(*Call, K);
  if (const auto *Load = dyn_cast<LoadInst>(P))
    return loaded(*Load, K);
  Known All{"", false, true};
  if (const auto *Phi = dyn_cast<PHINode>(P)) {
    for (unsigned N = 0; N < Phi->getNumIncomingValues(); ++N)
      merge(All, find(Phi->getIncomingValue(N),
                      *Phi->getIncomingBlock(N)->getTerminator(), K));
    return All;
  }
  if (const auto *Select = dyn_cast<SelectInst>(P)) {
    merge(All, find(Select->getTrueValue(), At, K));
    merge(All, find(Select->getFalseValue(), At, K));
    return All;
  }
  return inMemory(P, K);
}

Texts::Known Texts::find(const Value *Pointer, const Instruction &At, Kind K) {
  StringRef Plain;
  if (K == Kind::Text && getConstantStringInfo(Pointer, Plain))
    return {Plain.str()};
  if (Depth == MaxDepth)
    return {DynamicName};
  ++Depth;
  auto Leave = make_scope_exit([&] { --Depth; });
  // A null pointer leads to no object.
  if (isa<ConstantPointerNull>(Pointer))
    return {"", false, true};
  return follow(Pointer, At, K);
}

//===----------------------------------------------------------------------===//
// What is asked
//===----------------------------------------------------------------------===//

std::string Texts::textAt(const Value *Pointer, const Instruction &At) {
  if (!Pointer || !Pointer->getType()->isPointerTy())
    return DynamicName;
  Known K = find(Pointer, At, Kind::Text);
  return K.None ? DynamicName : K.Text;
}

std::string Texts::nameOf(const CallBase &Call, const Rule &Row) {
  std::string Name = textAt(argument(Call, Row, Row.Name), Call);
  const Value *Handle = Row.Handle ? objectOf(Call, Row) : nullptr;
  if (!Handle)
    return Name;
  return joinNames(find(Handle, Call, Kind::Handle).Text, Name);
}

const Constant *Texts::constantOf(const Value *V) {
  // Bounded by the arguments that lead to arguments.
  for (unsigned Steps = 0; Steps < MaxDepth; ++Steps) {
    if (const auto *Global = dyn_cast<GlobalVariable>(V))
      return Global->isConstant() && Global->hasInitializer()
                 ? Global->getInitializer()
                 : nullptr;
    if (const auto *C = dyn_cast<Constant>(V))
      return C;
    const Value *Next = nullptr;
    // In memory a bool is a byte.
    if (const auto *Wide = dyn_cast<ZExtInst>(V);
        Wide && Wide->getSrcTy()->isIntegerTy(1))
      Next = Wide->getOperand(0);
    else if (const auto *Arg = dyn_cast<Argument>(V)) {
      // Where several calls differ, nothing is the default.
      for (const CallBase *Call : Calls.callers(Arg->getParent())) {
        if (Call->getCalledFunction() != Arg->getParent() ||
            Arg->getArgNo() >= Call->arg_size() ||
            (Next && Next != Call->getArgOperand(Arg->getArgNo())))
          return nullptr;
        Next = Call->getArgOperand(Arg->getArgNo());
      }
    } else if (isa<AllocaInst>(V)) {
      // A temporary that one value is stored to, or that is made of one.
      for (const User *U : V->users()) {
        const auto *Store = dyn_cast<StoreInst>(U);
        const auto *Call = dyn_cast<CallBase>(U);
        const Value *One = Store ? Store->getValueOperand() : nullptr;
        if (Call && Call->arg_size() == 2 && Call->getArgOperand(0) == V)
          One = dyn_cast<Constant>(Call->getArgOperand(1));
        if (One && Next && Next != One)
          return nullptr;
        if (One)
          Next = One;
      }
    }
    if (!Next)
      return nullptr;
    V = Next;
  }
  return nullptr;
}

} // namespace tpc
