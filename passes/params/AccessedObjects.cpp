//===- AccessedObjects.cpp - Objects with a method that returns a value ---===//
//
// A read may make an object, such as an rclcpp::Parameter, and the program
// takes the value out of it elsewhere. Which read an object comes from is
// decided by, in this order: a test of the object's name on the way, the last
// assignment of a local variable, where the object is stored, and the name for
// which its function is called back.
//
//===----------------------------------------------------------------------===//
#include "memory/PointsTo.h"
#include "params/Callbacks.h"
#include "params/Idioms.h"
#include "params/ManyParameters.h"
#include "params/ParameterObjects.h"
#include "params/TextUsage.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/Dominators.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

#include <map>
#include <set>

using namespace llvm;

namespace tpc {

/// An object that a read made: the pointers to it, and where it is stored.
struct MadeObject {
  unsigned Read;
  const Value *Made; ///< the object itself
  SmallPtrSet<const Value *, 2> Pointers;
  Locations Where;
};

/// The object that \p Read returns; null if it returns the value itself.
static Value *objectOf(const ParameterRead &Read,
                       const StringSet<> &ObjectClasses) {
  if (Read.Row->Many == Rule::List)
    return Read.Call->hasStructRetAttr() ? Read.Call->getArgOperand(0)
                                         : nullptr;
  if (Read.Target)
    return ObjectClasses.contains(plainType(Read.Type)) ? Read.Target : nullptr;
  if (!Read.Type.empty() && !ObjectClasses.contains(plainType(Read.Type)))
    return nullptr;
  if (Read.Call->hasStructRetAttr())
    return Read.Call->getArgOperand(0);
  return Read.Call->getType()->isPointerTy() ? Read.Call : nullptr;
}

/// True if \p F is a constructor or an assignment: it gives its first argument
/// the value of the second, if there is one.
static bool givesValue(const Function &F) {
  const std::string Name = qualifiedName(F.getName());
  auto [Scope, Own] = StringRef(Name).rsplit("::");
  return Own == "operator=" || (!Own.empty() && Own == unscoped(Scope));
}

/// \p Made and the objects that it is copied to.
static MadeObject madeBy(unsigned Read, Value *Made, PointsTo &Pointers) {
  MadeObject O{Read, Made, {}, Pointers.resolve(Made, false)};
  O.Pointers.insert(Made);
  for (const User *U : Made->users()) {
    const auto *Assign = dyn_cast<CallBase>(U);
    const Function *F = Assign ? Assign->getCalledFunction() : nullptr;
    if (!F || Assign->arg_size() != 2 || Assign->getArgOperand(1) != Made ||
        !givesValue(*F))
      continue;
    const Value *To = Assign->getArgOperand(0);
    if (!To->getType()->isPointerTy())
      continue;
    O.Pointers.insert(To);
    append_range(O.Where, Pointers.resolve(To, false));
  }
  return O;
}

SmallVector<Value *, 1> valuesOf(CallBase &Call) {
  if (!Call.getType()->isPointerTy())
    return {&Call};
  SmallVector<Value *, 1> Loads;
  for (User *U : Call.users())
    if (auto *Load = dyn_cast<LoadInst>(U))
      Loads.push_back(Load);
  return Loads;
}

/// The C++ type for the number of a type, such as `(rclcpp::ParameterType)3`;
/// empty if \p Argument is none.
static StringRef typeOfNumber(StringRef Argument) {
  static constexpr StringRef Types[] = {
      "bool",        "long",        "double",      "std::string", "std::vector",
      "std::vector", "std::vector", "std::vector", "std::vector"};
  unsigned Number = 0;
  if (!Argument.consume_front("(rclcpp::ParameterType)") ||
      Argument.getAsInteger(10, Number) || Number == 0 ||
      Number > std::size(Types))
    return "";
  return Types[Number - 1];
}

std::string accessedType(const Function &F, const Rule &Row) {
  if (!Row.Type.empty())
    return Row.Type;
  std::string Type = functionArgument(F);
  if (StringRef Numbered = typeOfNumber(Type); !Numbered.empty())
    return Numbered.str();
  // Not if the argument is a value.
  if (Type.empty() || StringRef(Type).contains(')'))
    Type = resultType(F);
  return plainType(Type);
}

bool isObjectType(StringRef Type, const RuleMatches &Rules) {
  return isText(Type) || Rules.isContainer(plainType(Type));
}

/// The pointer to the object that \p Call, a method, returns.
static Value *objectFrom(CallBase &Call) {
  if (Call.hasStructRetAttr())
    return Call.getArgOperand(0);
  return Call.getType()->isPointerTy() ? &Call : nullptr;
}

namespace {

/// Finds the reads that the objects of one module come from.
class ObjectFinder {
public:
  ObjectFinder(Module &M, ModuleAnalysisManager &AM, Texts &Known,
               std::vector<ParameterRead> &Reads);

  void run();

private:
  /// Reads by number; none if it is not known.
  using Numbers = std::optional<SmallSetVector<unsigned, 2>>;
  struct Accessor {
    CallBase *Call;
    const Rule *Row;
  };

  void makeObjects();
  const Value *objectBehind(const Value *Object) const;
  std::set<std::string> namesTested(const CallBase &At, const Value *Object);
  void addTest(const CallBase &Test, const Rule &Row, const Value *Name,
               const CallBase &At, std::set<std::string> &Out);
  Numbers lastAssigned(const Value *Local, const Instruction &At,
                       unsigned Depth = 0);
  bool addReturned(const Function &F, SmallSetVector<unsigned, 2> &Out) const;
  SmallVector<unsigned, 2> storedAt(const Value *Object);
  std::set<std::string> namesGiven(const Argument &Given);
  void addValues(unsigned Read, StringRef Type, ArrayRef<Value *> Values);

  const RuleMatches &Rules;
  const CallGraphResult &Calls;
  PointsTo &Pointers;
  Texts &Known;
  std::vector<ParameterRead> &Reads;
  UserSources Sources;
  SmallVector<Accessor, 0> Accessors;
  StringSet<> Classes; ///< of the objects
  SmallVector<MadeObject, 0> Objects;
  /// Calls that return the name of an object, and those that compare texts.
  SmallVector<CallBase *, 0> Identities;
  /// The parameter whose objects a function is called back with; empty if it is
  /// one of another node.
  DenseMap<const Function *, std::string> CalledFor;
  std::map<const Function *, DominatorTree> Trees;
};

} // namespace

/// True if \p Call, described by \p Row, asks for a parameter of another node.
static bool isOfOtherNode(const CallBase &Call, const Rule &Row, Texts &Known) {
  const Value *Node = argument(Call, Row, Row.Node);
  std::string Name = Node ? Known.textAt(Node, Call) : "";
  return !Name.empty() && !isDynamic(Name);
}

ObjectFinder::ObjectFinder(Module &M, ModuleAnalysisManager &AM, Texts &Known,
                           std::vector<ParameterRead> &Reads)
    : Rules(AM.getResult<RuleAnalysis>(M)),
      Calls(AM.getResult<SimpleCallGraph>(M)),
      Pointers(AM.getResult<PointsToAnalysis>(M)), Known(Known), Reads(Reads),
      Sources(AM.getResult<OptionsAnalysis>(M)) {
  forEachCall(M, Rules, Rule::Accessor, [&](CallBase &Call, const Rule &Row) {
    Accessors.push_back({&Call, &Row});
    Classes.insert(StringRef(Row.Function).rsplit("::").first);
  });
  if (Accessors.empty())
    return;
  forEachCall(M, Rules, Rule::Identity, [&](CallBase &Call, const Rule &) {
    Identities.push_back(&Call);
  });
  forEachCall(M, Rules, Rule::Callback, [&](CallBase &Call, const Rule &Row) {
    if (!Row.Name)
      return;
    std::string Name = isOfOtherNode(Call, Row, Known)
                           ? std::string()
                           : Known.nameOf(Call, Row);
    for (unsigned N : Row.Callbacks)
      if (const Value *Argument = argument(Call, Row, N))
        for (const Function *F : calledBackBy(*Argument, Call, Sources)) {
          auto [It, New] = CalledFor.try_emplace(F, Name);
          if (!New && It->second != Name)
            It->second = DynamicName;
        }
  });
}

void ObjectFinder::makeObjects() {
  for (unsigned N = 0; N < Reads.size(); ++N)
    if (Value *Made = objectOf(Reads[N], Classes)) {
      Objects.push_back(madeBy(N, Made, Pointers));
      if (Reads[N].Row->Many == Rule::List) {
        Objects.back().Where.clear();
        Pointers.addElements(Made, Objects.back().Where);
      }
      Reads[N].Type = "";
      Reads[N].Target = nullptr;
    }
}

/// The object that accessors have taken \p Object out of: an accessor can
/// return an object that has accessors too.
const Value *ObjectFinder::objectBehind(const Value *Object) const {
  while (const auto *Outer = dyn_cast_or_null<CallBase>(Object)) {
    const Rule *Row = Rules.match(*Outer);
    if (!Row || Row->Kind != Rule::Accessor)
      break;
    Object = objectOf(*Outer, *Row);
  }
  return Object;
}

/// Adds the text that \p Test, described by \p Row, compares \p Name with, if
/// \p At is only reached where the two are equal.
void ObjectFinder::addTest(const CallBase &Test, const Rule &Row,
                           const Value *Name, const CallBase &At,
                           std::set<std::string> &Out) {
  bool IsEqual = Row.Relation == "==";
  if ((!IsEqual && Row.Relation != "!=") || Test.arg_size() != 2 ||
      Test.getFunction() != At.getFunction())
    return;
  const Value *Other =
      Test.getArgOperand(Test.getArgOperand(0) == Name ? 1 : 0);
  auto [It, New] = Trees.try_emplace(At.getFunction());
  if (New)
    It->second.recalculate(const_cast<Function &>(*At.getFunction()));
  for (const User *U : Test.users()) {
    const auto *Branch = dyn_cast<BranchInst>(U);
    if (!Branch || !Branch->isConditional())
      continue;
    BasicBlockEdge Taken(Branch->getParent(),
                         Branch->getSuccessor(IsEqual ? 0 : 1));
    if (It->second.dominates(Taken, At.getParent()))
      Out.insert(Known.textAt(Other, Test));
  }
}

/// The names with which the name of \p Object was compared on every way to
/// \p At.
std::set<std::string> ObjectFinder::namesTested(const CallBase &At,
                                                const Value *Object) {
  std::set<std::string> Found;
  for (const CallBase *Identity : Identities) {
    const Rule *Row = Rules.match(*Identity);
    const Value *Of = objectOf(*Identity, *Row);
    if (Identity->getFunction() != At.getFunction() || !Of ||
        !isSameVariable(Of, Object))
      continue;
    // The name itself, and the strings that are copies of it.
    SmallVector<const Value *, 2> Names{Identity};
    if (Identity->hasStructRetAttr())
      Names.front() = Identity->getArgOperand(0);
    for (unsigned N = 0; N < Names.size(); ++N)
      for (const User *U : Names[N]->users()) {
        const auto *Call = dyn_cast<CallBase>(U);
        const Rule *Does = Call ? Rules.match(*Call) : nullptr;
        if (!Does || Does->Kind != Rule::Text)
          continue;
        if (Does->Relation != "copy")
          addTest(*Call, *Does, Names[N], At, Found);
        else if (N == 0 && Call->arg_size() > 1 &&
                 Call->getArgOperand(1) == Names[N])
          Names.push_back(Call->getArgOperand(0));
      }
  }
  return Found;
}

/// True if the address of \p Local, a local object, is stored, such as in
/// a lambda that may assign to it.
static bool isKept(const Value &Local) {
  return any_of(Local.users(), [&](const User *U) {
    const auto *Store = dyn_cast<StoreInst>(U);
    return Store && Store->getValueOperand() == &Local;
  });
}

/// True if \p Call, of \p Callee, does not assign to its argument \p Local.
static bool leavesUnchanged(const CallBase &Call, const Function &Callee,
                            const Value *Local) {
  if (Callee.getName().starts_with("_ZNK") && Call.getArgOperand(0) == Local)
    return true;
  if (StringRef(qualifiedName(Callee.getName())).contains("::~"))
    return true;
  const SmallBitVector Const = constArguments(Callee);
  for (const auto &[N, Argument] : enumerate(Call.args()))
    if (Argument.get() == Local && (N >= Const.size() || !Const[N]))
      return false;
  return true;
}

/// The reads that gave \p Local, a local object, the value that it has at
/// \p At.
ObjectFinder::Numbers ObjectFinder::lastAssigned(const Value *Local,
                                                 const Instruction &At,
                                                 unsigned Depth) {
  constexpr unsigned MaxDepth = 4, MaxBlocks = 500;
  if (!isa<AllocaInst>(Local) || Depth == MaxDepth || isKept(*Local))
    return std::nullopt;
  SmallSetVector<unsigned, 2> Found;
  SmallPtrSet<const BasicBlock *, 16> Seen;
  SmallVector<const Instruction *, 8> Work;
  auto GoAbove = [&](const BasicBlock &BB) {
    for (const BasicBlock *Pred : predecessors(&BB))
      if (Seen.insert(Pred).second)
        Work.push_back(&Pred->back());
    return !pred_empty(&BB) && Seen.size() <= MaxBlocks;
  };
  // True if the search on this way has ended; none if nothing is known.
  auto Ends = [&](const CallBase &Call) -> std::optional<bool> {
    if (isa<IntrinsicInst>(Call) ||
        none_of(Call.args(), [&](const Use &U) { return U.get() == Local; }))
      return false;
    for (const MadeObject &O : Objects)
      if (Reads[O.Read].Call == &Call && O.Made == Local) {
        Found.insert(O.Read);
        return true;
      }
    const Function *Callee = Call.getCalledFunction();
    if (!Callee)
      return std::nullopt;
    if (Call.hasStructRetAttr() && Call.getArgOperand(0) == Local)
      return addReturned(*Callee, Found) ? std::optional(true) : std::nullopt;
    if (leavesUnchanged(Call, *Callee, Local))
      return false;
    if (Call.getArgOperand(0) != Local || !givesValue(*Callee))
      return std::nullopt;
    if (Call.arg_size() == 1)
      return true; // A new object, without a value.
    const Value *Source = objectBehind(Call.getArgOperand(1));
    Numbers From = lastAssigned(Source, Call, Depth + 1);
    // An element of a list is no local.
    SmallVector<unsigned, 2> Listed;
    if (!From && Source && !isa<AllocaInst>(Source))
      Listed = storedAt(Source);
    if (!From && Listed.empty())
      return std::nullopt;
    if (From)
      Found.insert(From->begin(), From->end());
    Found.insert(Listed.begin(), Listed.end());
    return true;
  };
  if (const Instruction *Above = At.getPrevNode())
    Work.push_back(Above);
  else if (!GoAbove(*At.getParent()))
    return std::nullopt;
  while (!Work.empty()) {
    const Instruction *I = Work.pop_back_val();
    const BasicBlock *BB = I->getParent();
    std::optional<bool> Ended = false;
    for (; I && !*Ended; I = I->getPrevNode())
      if (const auto *Call = dyn_cast<CallBase>(I))
        if (Ended = Ends(*Call); !Ended)
          return std::nullopt;
    if (!*Ended && !GoAbove(*BB))
      return std::nullopt;
  }
  return Found.empty() ? std::nullopt : Numbers(std::move(Found));
}

/// Adds the reads that make the object that \p F returns; false if there are
/// none.
bool ObjectFinder::addReturned(const Function &F,
                               SmallSetVector<unsigned, 2> &Out) const {
  bool IsFound = false;
  for (const MadeObject &O : Objects)
    if (const auto *Result = dyn_cast<Argument>(O.Made);
        Result && Result->getParent() == &F && Result->hasStructRetAttr()) {
      Out.insert(O.Read);
      IsFound = true;
    }
  return IsFound;
}

/// The reads whose objects are stored where \p Object is.
SmallVector<unsigned, 2> ObjectFinder::storedAt(const Value *Object) {
  SmallVector<unsigned, 2> Found;
  Locations Where = Pointers.resolve(Object, false);
  std::optional<unsigned> Index = indexOf(Object);
  for (const MadeObject &O : Objects) {
    if (Index && Reads[O.Read].Index && Index != Reads[O.Read].Index)
      continue;
    if (O.Pointers.contains(Object) || any_of(Where, [&](const auto &L) {
          return any_of(O.Where, [&](const auto &P) { return L.mayBe(P); });
        }))
      Found.push_back(O.Read);
  }
  return Found;
}

/// The names of the objects that the program's own functions hand to \p Given,
/// and of those that its function is called back with. None if they are
/// parameters of other nodes.
std::set<std::string> ObjectFinder::namesGiven(const Argument &Given) {
  std::set<std::string> Found;
  bool IsOfOthers = false;
  SmallSetVector<const Argument *, 4> Work;
  Work.insert(&Given);
  for (unsigned N = 0; N < Work.size(); ++N) {
    const Function &F = *Work[N]->getParent();
    const unsigned Number = Work[N]->getArgNo();
    if (auto Called = CalledFor.find(&F); Called != CalledFor.end()) {
      if (Called->second.empty())
        IsOfOthers = true;
      else
        Found.insert(Called->second);
    }
    for (const CallBase *Call : Calls.callers(&F)) {
      if (!Sources.has(*Call->getFunction()) || Number >= Call->arg_size())
        continue;
      const Value *Object = Call->getArgOperand(Number);
      std::set<std::string> Names = namesTested(*Call, Object);
      Found.insert(Names.begin(), Names.end());
      if (!Names.empty())
        continue;
      if (const auto *Further = dyn_cast<Argument>(Object))
        Work.insert(Further);
      else
        Found.insert(DynamicName);
    }
  }
  if (Found.empty() && !IsOfOthers)
    Found.insert(DynamicName);
  return Found;
}

void ObjectFinder::addValues(unsigned Number, StringRef Type,
                             ArrayRef<Value *> Values) {
  ParameterRead &Read = Reads[Number];
  append_range(Read.Values, Values);
  if (Read.Type.empty())
    Read.Type = Type;
}

void ObjectFinder::run() {
  if (Accessors.empty())
    return;
  makeObjects();
  for (const Accessor &A : Accessors) {
    const Value *Object = objectBehind(objectOf(*A.Call, *A.Row));
    std::string Type = accessedType(*A.Call->getCalledFunction(), *A.Row);
    SmallVector<Value *, 1> Values;
    if (!isObjectType(Type, Rules))
      Values = valuesOf(*A.Call);
    else if (Value *Own = objectFrom(*A.Call))
      Values.push_back(Own);
    if (!Object || Values.empty())
      continue;
    auto AddRead = [&](std::string Name) {
      Reads.push_back({A.Call, A.Row, std::move(Name), Type, nullptr, nullptr,
                       SmallVector<Value *, 1>(Values)});
    };
    if (auto Names = namesTested(*A.Call, Object); !Names.empty()) {
      for_each(Names, AddRead);
      continue;
    }
    SmallVector<unsigned, 2> From;
    if (Numbers Last = lastAssigned(Object, *A.Call))
      From.assign(Last->begin(), Last->end());
    else
      From = storedAt(Object);
    for (unsigned Number : From)
      addValues(Number, Type, Values);
    if (!From.empty())
      continue;
    if (const auto *Given = dyn_cast<Argument>(Object))
      for_each(namesGiven(*Given), AddRead);
    else
      AddRead(DynamicName);
  }
}

void findAccessors(Module &M, ModuleAnalysisManager &AM, Texts &Known,
                   std::vector<ParameterRead> &Reads) {
  ObjectFinder(M, AM, Known, Reads).run();
}

} // namespace tpc
