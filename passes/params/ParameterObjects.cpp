//===- ParameterObjects.cpp -----------------------------------------------===//
#include "params/ParameterObjects.h"

#include "Options.h"
#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/IR/Module.h"

#include <map>

using namespace llvm;

namespace tpc {

//===----------------------------------------------------------------------===//
// Objects with a method that returns the value
//===----------------------------------------------------------------------===//

/// An object that a read made: the pointers to it, and where it is stored.
struct MadeObject {
  unsigned Read;
  SmallPtrSet<const Value *, 2> Pointers;
  Locations Where;
};

/// The object that \p Read returns; null if it returns the value itself.
static Value *objectOf(const ParameterRead &Read,
                       const StringSet<> &ObjectClasses) {
  if (Read.Target)
    return ObjectClasses.contains(plainType(Read.Type)) ? Read.Target : nullptr;
  if (!Read.Type.empty() && !ObjectClasses.contains(plainType(Read.Type)))
    return nullptr;
  if (Read.Call->hasStructRetAttr())
    return Read.Call->getArgOperand(0);
  return Read.Call->getType()->isPointerTy() ? Read.Call : nullptr;
}

/// \p Made and the objects that it is copied to: a call whose only arguments
/// are it and another object is an assignment or a copy constructor.
static MadeObject madeBy(unsigned Read, Value *Made, PointsTo &Pointers) {
  MadeObject O{Read, {}, Pointers.resolve(Made, false)};
  O.Pointers.insert(Made->stripPointerCasts());
  for (const User *U : Made->users()) {
    const auto *Assign = dyn_cast<CallBase>(U);
    if (!Assign || Assign->arg_size() != 2 || Assign->getArgOperand(1) != Made)
      continue;
    const Value *To = Assign->getArgOperand(0);
    if (!To->getType()->isPointerTy())
      continue;
    O.Pointers.insert(To->stripPointerCasts());
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

void findAccessors(Module &M, ModuleAnalysisManager &AM,
                   std::vector<ParameterRead> &Reads) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  PointsTo &Pointers = AM.getResult<PointsToAnalysis>(M);
  struct Accessor {
    CallBase *Call;
    const Rule *Row;
  };
  SmallVector<Accessor, 0> Accessors;
  StringSet<> Classes;
  forEachCall(M, Rules, Rule::Accessor, [&](CallBase &Call, const Rule &Row) {
    Accessors.push_back({&Call, &Row});
    Classes.insert(StringRef(Row.Function).rsplit("::").first);
  });
  if (Accessors.empty())
    return;
  SmallVector<MadeObject, 0> Objects;
  for (unsigned N = 0; N < Reads.size(); ++N)
    if (Value *Made = objectOf(Reads[N], Classes)) {
      Objects.push_back(madeBy(N, Made, Pointers));
      Reads[N].Type = "";
      Reads[N].Target = nullptr;
    }
  for (auto [Call, Row] : Accessors) {
    const Value *Object = objectOf(*Call, *Row);
    // An accessor can return an object that has accessors too.
    while (const auto *Outer = dyn_cast_or_null<CallBase>(Object)) {
      const Rule *OuterRow = Rules.match(*Outer);
      if (!OuterRow || OuterRow->Kind != Rule::Accessor)
        break;
      Object = objectOf(*Outer, *OuterRow);
    }
    std::string Type = plainType(resultType(*Call->getCalledFunction()));
    SmallVector<Value *, 1> Values = valuesOf(*Call);
    if (!Object || Values.empty())
      continue;
    Object = Object->stripPointerCasts();
    Locations Where = Pointers.resolve(Object, false);
    bool Found = false;
    for (const MadeObject &O : Objects) {
      if (!O.Pointers.contains(Object) && none_of(Where, [&](const auto &L) {
            return any_of(O.Where, [&](const auto &P) { return L.mayBe(P); });
          }))
        continue;
      Found = true;
      ParameterRead &Read = Reads[O.Read];
      append_range(Read.Values, Values);
      if (Read.Type.empty())
        Read.Type = Type;
    }
    if (!Found)
      Reads.push_back({Call, Row, DynamicName, Type, nullptr, nullptr,
                       SmallVector<Value *, 1>(Values)});
  }
}

//===----------------------------------------------------------------------===//
// Classes whose fields are all parameters
//===----------------------------------------------------------------------===//

std::string nameWithScopes(const DICompositeType &Class) {
  std::string Name = Class.getName().str();
  for (const DIScope *S = Class.getScope(); S; S = S->getScope())
    if (isa<DINamespace>(S) || isa<DICompositeType>(S))
      Name = (S->getName() + "::" + Name).str();
  return Name;
}

/// A field of a class: its name, its type, its default, and where it is read:
/// loads or, for text, pointers to it.
struct Field {
  std::string Name, Type;
  json::Value Default = nullptr;
  SmallVector<Value *, 1> Values;
};

/// Gives \p Fields of the class \p Name the defaults that the generated code
/// sets: constants that are stored to a field of a variable `__default__`.
static void findDefaults(Module &M, StringRef Name, ModuleAnalysisManager &AM,
                         std::map<unsigned, Field> &Fields) {
  const LocationTypes &Types = AM.getResult<LocationTypesAnalysis>(M);
  PointsTo &Pointers = AM.getResult<PointsToAnalysis>(M);
  std::string Statics = (Name + "Statics::").str();
  for (Function &F : definedFunctions(M)) {
    if (!StringRef(qualifiedName(F.getName())).starts_with(Statics))
      continue;
    for (Instruction &I : instructions(F)) {
      auto *Store = dyn_cast<StoreInst>(&I);
      auto *Value =
          Store ? dyn_cast<Constant>(Store->getValueOperand()) : nullptr;
      if (!Value)
        continue;
      for (const Location &L :
           Pointers.resolve(Store->getPointerOperand(), true))
        if (L.Path.size() > 1 &&
            Types.fieldName(L.Path[L.Path.size() - 2]) == "__default__")
          if (auto It = Fields.find(L.Path.back().Index); It != Fields.end())
            It->second.Default = jsonOf(*Value, It->second.Type);
    }
  }
}

/// The field of the class \p Name that \p Where leads to; none if it leads
/// elsewhere.
static std::optional<Step> fieldAt(const Location &Where, StringRef Name,
                                   const LocationTypes &Types) {
  if (!Where.isField())
    return std::nullopt;
  const DICompositeType *Class = Types.sourceClassOf(Where.Path.back());
  if (!Class || nameWithScopes(*Class) != Name)
    return std::nullopt;
  return Where.Path.back();
}

/// Adds to \p Fields those of the class \p Name that are text and that user
/// code gets pointers to.
static void addTexts(Module &M, StringRef Name, ModuleAnalysisManager &AM,
                     std::map<unsigned, Field> &Fields) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  const LocationTypes &Types = AM.getResult<LocationTypesAnalysis>(M);
  PointsTo &Pointers = AM.getResult<PointsToAnalysis>(M);
  UserSources Sources(AM.getResult<OptionsAnalysis>(M));
  auto IsText = [](Type *T) {
    const auto *Class = dyn_cast_or_null<StructType>(T);
    return Class && plainClassName(*Class) == "std::__cxx11::basic_string";
  };
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F) || !Sources.has(F))
      continue;
    for (Instruction &I : instructions(F)) {
      auto *GEP = dyn_cast<GetElementPtrInst>(&I);
      if (!GEP || !IsText(GEP->getResultElementType()))
        continue;
      for (const Location &L : Pointers.resolve(GEP, /*Scalar=*/false))
        if (std::optional<Step> S = fieldAt(L, Name, Types)) {
          Field &Found = Fields[S->Index];
          Found.Name = Types.fieldName(*S);
          Found.Type = "std::string";
          if (!is_contained(Found.Values, GEP))
            Found.Values.push_back(GEP);
        }
    }
  }
}

/// The fields of the class \p Name that user code reads, by position.
static std::map<unsigned, Field> fieldsOf(Module &M, StringRef Name,
                                          ModuleAnalysisManager &AM) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  const LocationTypes &Types = AM.getResult<LocationTypesAnalysis>(M);
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  UserSources Sources(Opts);
  std::map<unsigned, Field> Fields;
  for (const auto &[I, Where] : AM.getResult<ClassObjectAccess>(M).loads()) {
    if (Rules.isOpaque(*I->getFunction()) || !Sources.has(I->getDebugLoc()))
      continue;
    std::optional<Step> S = fieldAt(Where, Name, Types);
    if (!S)
      continue;
    Field &F = Fields[S->Index];
    F.Name = Types.fieldName(*S);
    if (const DIType *T = Types.sourceTypeOf(*S))
      F.Type = T->getName();
    if (!is_contained(F.Values, I))
      F.Values.push_back(I);
  }
  addTexts(M, Name, AM, Fields);
  return Fields;
}

void findConfigs(Module &M, ModuleAnalysisManager &AM, Texts &Known,
                 std::vector<ParameterRead> &Reads) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  // The first call for each class, and the namespace of all its servers.
  struct Served {
    CallBase *Call;
    const Rule *Row;
    std::string Namespace;
  };
  MapVector<std::string, Served, std::map<std::string, unsigned>> Classes;
  forEachCall(M, Rules, Rule::Config, [&](CallBase &Call, const Rule &Row) {
    std::string Class = classArgument(*Call.getCalledFunction());
    if (Class.empty())
      return;
    std::string Namespace = Known.namespaceOf(Call, Row);
    auto [It, New] = Classes.insert({Class, {&Call, &Row, Namespace}});
    // Servers of one class pass their values to the same fields.
    if (It->second.Namespace != Namespace)
      It->second.Namespace = DynamicName;
  });
  for (const auto &[Class, S] : Classes) {
    std::map<unsigned, Field> Fields = fieldsOf(M, Class, AM);
    findDefaults(M, Class, AM, Fields);
    for (auto &[Index, F] : Fields)
      Reads.push_back(
          {S.Call, S.Row,
           joinNames(S.Namespace, F.Name.empty() ? DynamicName : F.Name),
           F.Type, std::move(F.Default), nullptr, std::move(F.Values), F.Name});
  }
}

} // namespace tpc
