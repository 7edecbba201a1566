//===- AccessedObjects.cpp - Objects with a method that returns a value ---===//
//
// A read may make an object, such as an rclcpp::Parameter, and the program
// takes the value out of it elsewhere. Which read an object comes from is
// decided by, in this order: a test of the object's name on the way (see
// ObjectNames.h), the last assignment of a local variable, where the object is
// stored (MadeObjects.h), and the name for which its function is called back.
//
//===----------------------------------------------------------------------===//
#include "params/MadeObjects.h"
#include "params/ObjectNames.h"
#include "params/ParameterObjects.h"
#include "params/TextUsage.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/ADT/StringSet.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

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

/// Adds \p Values, which have the type \p Type, to those of \p Read.
static void addValues(ParameterRead &Read, StringRef Type,
                      ArrayRef<Value *> Values) {
  append_range(Read.Values, Values);
  if (Read.Type.empty())
    Read.Type = Type;
}

void findAccessors(Module &M, ModuleAnalysisManager &AM, Texts &Known,
                   std::vector<ParameterRead> &Reads) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  SmallVector<std::pair<CallBase *, const Rule *>, 0> Accessors;
  StringSet<> Classes; // of the objects
  forEachCall(M, Rules, Rule::Accessor, [&](CallBase &Call, const Rule &Row) {
    Accessors.push_back({&Call, &Row});
    Classes.insert(StringRef(Row.Function).rsplit("::").first);
  });
  if (Accessors.empty())
    return;
  MadeObjects Objects(Reads, Rules, AM.getResult<PointsToAnalysis>(M));
  for (unsigned N = 0; N < Reads.size(); ++N)
    if (Value *Made = objectOf(Reads[N], Classes)) {
      Objects.add(N, Made);
      Reads[N].Type = "";
      Reads[N].Target = nullptr;
    }
  ObjectNames Names(M, AM, Known);
  for (auto [Call, Row] : Accessors) {
    const Value *Object = objectBehind(objectOf(*Call, *Row), Rules);
    std::string Type = accessedType(*Call->getCalledFunction(), *Row);
    SmallVector<Value *, 1> Values;
    if (!isObjectType(Type, Rules))
      Values = valuesOf(*Call);
    else if (Value *Own = objectFrom(*Call))
      Values.push_back(Own);
    if (!Object || Values.empty())
      continue;
    auto AddRead = [&, Call = Call, Row = Row](std::string Name) {
      Reads.push_back({Call, Row, std::move(Name), Type, nullptr, nullptr,
                       SmallVector<Value *, 1>(Values)});
    };
    if (auto Tested = Names.testedOn(*Call, Object); !Tested.empty()) {
      for_each(Tested, AddRead);
      continue;
    }
    SmallVector<unsigned, 2> From = Objects.readsOf(Object, *Call);
    for (unsigned Number : From)
      addValues(Reads[Number], Type, Values);
    if (!From.empty())
      continue;
    if (const auto *Given = dyn_cast<Argument>(Object))
      for_each(Names.givenTo(*Given), AddRead);
    else
      AddRead(DynamicName);
  }
}

} // namespace tpc
