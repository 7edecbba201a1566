//===- ParameterObjects.cpp -----------------------------------------------===//
#include "params/ParameterObjects.h"

#include "Options.h"
#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/ADT/MapVector.h"
#include "llvm/IR/Module.h"

#include <map>

using namespace llvm;

namespace tpc {

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
