//===- Messages.cpp -------------------------------------------------------===//
#include "results/Messages.h"

#include "params/Callbacks.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/StringExtras.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/Support/CommandLine.h"

#include <deque>

using namespace llvm;

namespace tpc {

/// Most comparisons end at a callback within a hundred steps; what is farther
/// says little of the message.
static cl::opt<unsigned>
    MaxSteps("tpc-max-message-steps", cl::Hidden, cl::init(2000),
             cl::desc("Instructions that are searched for the messages that a "
                      "comparison depends on"));

/// `std_msgs/Bool` for the class of a message or a smart pointer to one; empty
/// for other types.
static std::string messageType(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(DebugTypes::plain(T));
  if (!Class)
    return "";
  if (isSmartPointer(Class) || Class->getName().starts_with("MessageEvent<"))
    return messageType(firstArgumentOf(*Class));
  if (!isMessageClass(*Class))
    return "";
  std::string Name = Class->getName().split("_<").first.str();
  for (const DIScope *S = Class->getScope(); S; S = S->getScope())
    if (!S->getName().empty() && isa<DINamespace>(S))
      Name = (S->getName() + "/" + Name).str();
  return Name;
}

/// The same for the name of such a class in C++.
static std::string typeNamed(StringRef Class) {
  auto [Name, Arguments] = Class.split("_<");
  SmallVector<StringRef, 3> Parts;
  Name.split(Parts, "::");
  return Arguments.starts_with("std::allocator<") ? join(Parts, "/") : "";
}

std::string Messages::typeOf(const Value &V) const {
  if (!V.getType()->isPointerTy())
    return "";
  if (const auto *Arg = dyn_cast<Argument>(&V)) {
    const DIType *Declared = DebugTypes::declared(*Arg);
    if (const DIType *To = DebugTypes::dereferenced(Declared))
      Declared = To;
    if (std::string Name = messageType(Declared); !Name.empty())
      return Name;
  }
  return messageType(Debug.pointee(&V));
}

std::string Messages::typeOf(const CallBase &Call) const {
  // The first argument is the publisher.
  for (const Value *Arg : drop_begin(Call.args()))
    if (std::string Name = typeOf(*Arg); !Name.empty())
      return Name;
  return "";
}

namespace {

/// Finds the functions in user code that an object which keeps a function, such
/// as the result of boost::bind, was made of: those that are named where it and
/// what it is made of are made.
class KeptFunctions {
public:
  explicit KeptFunctions(UserSources &Sources) : Sources(Sources) {}

  /// Adds those of the local object \p Local, an argument of \p Call.
  void addFrom(const Value &Local, const CallBase &Call) {
    push(&Local);
    while (!Work.empty())
      made(*Work.pop_back_val(), Call);
  }
  SmallSetVector<Function *, 2> Found;

private:
  void push(const Value *V) {
    if (isa<AllocaInst>(V) && Seen.insert(V).second)
      Work.push_back(V);
    else if (isa<Function, ConstantExpr, ConstantAggregate>(V))
      named(*cast<Constant>(V));
  }
  void named(const Constant &C);
  void made(const Value &Local, const CallBase &Call);

  UserSources &Sources;
  SmallVector<const Value *, 8> Work;
  SmallPtrSet<const Value *, 8> Seen;
};

} // namespace

void KeptFunctions::named(const Constant &C) {
  if (const auto *F = dyn_cast<Function>(&C)) {
    if (!F->isDeclaration() && Sources.has(*F))
      Found.insert(const_cast<Function *>(F));
  } else if (isa<ConstantExpr, ConstantAggregate>(C)) {
    for (const Value *Part : C.operands())
      named(*cast<Constant>(Part));
  }
}

void KeptFunctions::made(const Value &Local, const CallBase &Call) {
  for (const User *U : Local.users())
    if (const auto *Store = dyn_cast<StoreInst>(U)) {
      push(Store->getValueOperand());
    } else if (const auto *Copy = dyn_cast<MemTransferInst>(U)) {
      push(Copy->getRawSource());
    } else if (const auto *Makes = dyn_cast<CallBase>(U);
               Makes && Makes != &Call && !isa<IntrinsicInst>(Makes) &&
               !Makes->arg_empty() && Makes->getArgOperand(0) == &Local) {
      for (const Value *Part : Makes->args())
        push(Part);
      // A boost::function is made by a template for the class of a lambda.
      for (Function *F : calledBackBy(Local, *Makes, Sources))
        Found.insert(F);
    }
}

/// The functions that \p Call, a subscription, calls with its messages.
static SmallSetVector<Function *, 2>
callbacksOf(const CallBase &Call, const Rule &Row, UserSources &Sources) {
  KeptFunctions Kept(Sources);
  for (unsigned N : Row.Callbacks)
    if (const Value *Callback = argument(Call, Row, N)) {
      for (Function *F : calledBackBy(*Callback, Call, Sources))
        Kept.Found.insert(F);
      if (Kept.Found.empty())
        Kept.addFrom(*Callback, Call);
    }
  return Kept.Found;
}

Messages::Messages(Module &M, ModuleAnalysisManager &AM)
    : Calls(AM.getResult<SimpleCallGraph>(M)),
      Ifs(AM.getResult<IfStatements>(M)),
      Writes(AM.getResult<VisibleWritesAnalysis>(M)),
      Debug(AM.getResult<DebugTypesAnalysis>(M)) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  UserSources Sources(AM.getResult<OptionsAnalysis>(M));
  Texts Known(Rules, Calls, Texts::MemoryView::of(M, AM));
  SmallVector<const CallBase *, 4> Keepers;
  for (Function &In : definedFunctions(M))
    for (Instruction &I : instructions(In)) {
      const auto *Call = dyn_cast<CallBase>(&I);
      const Rule *Row = Call ? Rules.subscription(*Call) : nullptr;
      if (!Row || Rules.isOpaque(In))
        continue;
      if (!Row->Name) {
        Keepers.push_back(Call);
        continue;
      }
      const SmallSetVector<Function *, 2> Found =
          callbacksOf(*Call, *Row, Sources);
      if (Found.empty() && !Row->Callbacks.empty())
        continue;
      std::string Topic = Known.nameOf(*Call, *Row);
      auto Made = std::make_unique<Subscription>(
          Subscription{Call, isDynamic(Topic) ? "" : std::move(Topic), ""});
      for (const Function *F : Found) {
        ByCallback[F].push_back(Made.get());
        for (const Argument &Arg : F->args())
          if (Made->Type.empty())
            Made->Type = typeOf(Arg);
      }
      if (Row->Callbacks.empty())
        Made->Type = typeNamed(classArgument(*Call->getCalledFunction()));
      All.push_back(std::move(Made));
    }
  addFeeds(Sources, Rules, Keepers);
}

/// A subscription without callbacks feeds a filter. Of the callbacks that
/// filters keep, \p Keepers are the calls: they get the messages of the only
/// such subscription to their type, whatever filters are in between.
void Messages::addFeeds(UserSources &Sources, const RuleMatches &Rules,
                        ArrayRef<const CallBase *> Keepers) {
  StringMap<SmallVector<const Subscription *, 1>> Feeds;
  for (const auto &S : All)
    if (Rules.subscription(*S->At)->Callbacks.empty() && !S->Type.empty())
      Feeds[S->Type].push_back(S.get());
  for (const CallBase *Call : Keepers)
    for (const Function *F :
         callbacksOf(*Call, *Rules.subscription(*Call), Sources))
      for (const Argument &Arg : F->args())
        if (const auto It = Feeds.find(typeOf(Arg));
            It != Feeds.end() && all_of(It->second, [&](const auto *S) {
              // A constructor subscribes by another such call.
              return S->Topic == It->second.front()->Topic;
            }))
          ByCallback[F].push_back(It->second.front());
}

/// Searches backwards from one comparison, breadth first.
class Messages::Search {
public:
  explicit Search(const Messages &Of) : Of(Of) {}

  void value(const Value *V) { push(V, false); }
  /// What decides whether \p I runs.
  void runs(const Instruction *I) { push(I, true); }
  /// Goes to the end; what is found from here on is \p IsValue.
  void run(bool IsValue);

  SmallVector<ReceivedMessage, 2> Found;

private:
  using Item = PointerIntPair<const Value *, 1, bool>;
  void push(const Value *V, bool Runs) {
    if (V && !isa<BasicBlock>(V) && (!isa<Constant>(V) || isa<GEPOperator>(V)))
      if (Seen.insert(Item(V, Runs)).second)
        Work.push_back(Item(V, Runs));
  }
  void condition(const Instruction *Decider);
  bool isOfMessage(const Value *Pointer);
  void valueOf(const Value *V);
  void written(const Instruction &Write);
  void controlled(const Instruction &I);
  bool arrives(const Function &F);

  const Messages &Of;
  bool IsValue = true;
  std::deque<Item> Work;
  DenseSet<Item> Seen;
  SmallPtrSet<const Subscription *, 4> Known;
};

/// True if \p F is the callback of subscriptions; adds them.
bool Messages::Search::arrives(const Function &F) {
  const auto *It = Of.ByCallback.find(&F);
  if (It == Of.ByCallback.end())
    return false;
  for (const Subscription *S : It->second)
    if (Known.insert(S).second)
      Found.push_back({S, IsValue});
  return true;
}

void Messages::Search::condition(const Instruction *Decider) {
  if (isPredicate(*Decider))
    value(conditionOf(*Decider));
  runs(Decider);
}

void Messages::Search::controlled(const Instruction &I) {
  for (const Instruction *Decider : Of.Ifs.controllers(I))
    condition(Decider);
  const Function &F = *I.getFunction();
  if (!arrives(F))
    for (const CallBase *Call : Of.Calls.callers(&F))
      runs(Call);
}

/// What \p Write puts into memory, and whether it does.
void Messages::Search::written(const Instruction &Write) {
  runs(&Write);
  if (const auto *Store = dyn_cast<StoreInst>(&Write))
    return value(Store->getValueOperand());
  if (const auto *Copy = dyn_cast<MemTransferInst>(&Write))
    return value(Copy->getRawSource());
  for (const Use &U : Write.operands())
    value(U);
}

/// True if \p Pointer leads into the message that a callback gets.
bool Messages::Search::isOfMessage(const Value *Pointer) {
  const Value *Base = PointsTo::baseOf(Pointer);
  while (const auto *Load = dyn_cast<LoadInst>(Base))
    Base = PointsTo::baseOf(Load->getPointerOperand());
  const auto *Arg = dyn_cast<Argument>(Base);
  return Arg && Of.ByCallback.contains(Arg->getParent()) &&
         !Of.typeOf(*Arg).empty() && arrives(*Arg->getParent());
}

void Messages::Search::valueOf(const Value *V) {
  if (const auto *Arg = dyn_cast<Argument>(V)) {
    // The object of a method is no message.
    const Function &F = *Arg->getParent();
    bool IsCallback = Of.ByCallback.contains(&F);
    if (IsCallback && !Of.typeOf(*Arg).empty())
      arrives(F);
    for (const CallBase *Call : Of.Calls.callers(&F))
      if (!IsCallback && Arg->getArgNo() < Call->arg_size())
        value(Call->getArgOperand(Arg->getArgNo()));
    return;
  }
  const auto *I = dyn_cast<User>(V);
  if (!I)
    return;
  if (const auto *Load = dyn_cast<LoadInst>(I)) {
    if (isOfMessage(Load->getPointerOperand()))
      return;
    for (const Instruction *Write : Of.Writes.definitionsOf(*Load))
      written(*Write);
  } else if (const auto *Phi = dyn_cast<PHINode>(I)) {
    for (const BasicBlock *From : Phi->blocks())
      for (const Instruction *Decider : Of.Ifs.choosers(From, Phi->getParent()))
        condition(Decider);
  } else if (const auto *Call = dyn_cast<CallBase>(I)) {
    SmallVector<Function *, 1> Callees = Of.Calls.callees(*Call);
    for (const Function *Callee : Callees)
      for (const BasicBlock &BB : *Callee)
        if (const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator()))
          value(Return->getReturnValue());
    if (!Callees.empty())
      return;
  }
  for (const Use &U : I->operands())
    value(U);
}

void Messages::Search::run(bool Value) {
  IsValue = Value;
  const size_t Most = Seen.size() + MaxSteps;
  for (; !Work.empty() && Seen.size() < Most; Work.pop_front()) {
    const Item It = Work.front();
    if (It.getInt())
      controlled(*cast<Instruction>(It.getPointer()));
    else
      valueOf(It.getPointer());
  }
  Work.clear();
}

SmallVector<ReceivedMessage, 2> Messages::of(const Comparison &C) {
  if (ByCallback.empty())
    return {};
  Search Backwards(*this);
  if (C.Compare)
    Backwards.value(C.Compare->getOperand(1 - C.Threshold));
  else if (!C.TextRelation.empty())
    Backwards.value(C.FlagValue);
  Backwards.run(/*IsValue=*/true);
  Backwards.runs(&C.place());
  Backwards.run(/*IsValue=*/false);
  return std::move(Backwards.Found);
}

} // namespace tpc
