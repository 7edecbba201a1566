//===- ParamCallFinder.cpp ------------------------------------------------===//
#include "ParamCallFinder.h"

#include "Names.h"
#include "Print.h"

#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/FormatVariadic.h"

#include <cstdlib>

using namespace llvm;

namespace tpc {

AnalysisKey ParamCallFinder::Key;

/// The name of a result's type, which only templates have in their names.
static std::string resultType(const Function &F) {
  ItaniumPartialDemangler Demangler;
  std::string Name = F.getName().str();
  std::string Text;
  if (!Demangler.partialDemangle(Name.c_str()) && Demangler.isFunction()) {
    char *Type = Demangler.getFunctionReturnType(nullptr, nullptr);
    Text = Type ? Type : "";
    std::free(Type);
  }
  const Type *T = F.getReturnType();
  if (Text.empty())
    Text = T->isDoubleTy()      ? "double"
           : T->isFloatTy()     ? "float"
           : T->isIntegerTy(1)  ? "bool"
           : T->isIntegerTy(32) ? "int"
           : T->isIntegerTy()   ? "long"
                                : "";
  return Text;
}

/// `double` from `double&` or `double const&`.
static std::string valueType(const Function &F, const Rule &R) {
  SmallVector<std::string, 4> Types = parameterTypes(F);
  unsigned Number = R.Value.value_or(R.Default.value_or(~0U));
  if (Number >= Types.size())
    return R.Value ? "" : resultType(F);
  StringRef T = Types[Number];
  T.consume_back("&");
  T.consume_back(" const");
  if (T.starts_with("std::__cxx11::basic_string<char"))
    return "std::string";
  return T.str();
}

/// The constant that \p Pointer is known to point to: a constant global, or a
/// temporary that one constant is stored to.
static const Constant *pointedConstant(const Value *Pointer) {
  if (const auto *Global = dyn_cast<GlobalVariable>(Pointer))
    return Global->isConstant() && Global->hasInitializer()
               ? Global->getInitializer()
               : nullptr;
  if (!isa<AllocaInst>(Pointer))
    return nullptr;
  const Constant *Found = nullptr;
  for (const User *U : Pointer->users())
    if (const auto *Store = dyn_cast<StoreInst>(U)) {
      const auto *C = dyn_cast<Constant>(Store->getValueOperand());
      if (!C || (Found && Found != C))
        return nullptr;
      Found = C;
    }
  return Found;
}

static json::Value defaultOf(const CallBase &Call, const Rule &R,
                             StringRef Type) {
  const Value *V = argument(Call, R, R.Default);
  if (!V)
    return nullptr;
  const Constant *C = dyn_cast<Constant>(V);
  if (V->getType()->isPointerTy()) {
    if (std::optional<std::string> Text = constantText(V))
      return json::fixUTF8(*Text);
    C = pointedConstant(V);
  }
  if (const auto *Int = dyn_cast_or_null<ConstantInt>(C)) {
    if (Type == "bool" || Int->getBitWidth() == 1)
      return !Int->isZero();
    if (Int->getBitWidth() > 64)
      return nullptr;
    if (Type.starts_with("unsigned"))
      return Int->getZExtValue();
    return Int->getSExtValue();
  }
  if (const auto *Float = dyn_cast_or_null<ConstantFP>(C)) {
    APFloat Value = Float->getValueAPF();
    bool Loses;
    Value.convert(APFloat::IEEEdouble(), APFloat::rmNearestTiesToEven, &Loses);
    // JSON has no infinity and no NaN.
    return Value.isFinite() ? json::Value(Value.convertToDouble())
                            : json::Value(nullptr);
  }
  return nullptr;
}

ParamCallFinder::Result ParamCallFinder::run(Module &M,
                                             ModuleAnalysisManager &AM) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  Result R;
  forEachCall(M, Rules, Rule::Read, [&](CallBase &Call, const Rule &Row) {
    std::string Type = valueType(*Call.getCalledFunction(), Row);
    json::Value Default = defaultOf(Call, Row, Type);
    R.push_back(
        {&Call, &Row,
         constantText(argument(Call, Row, Row.Name)).value_or(DynamicName),
         std::move(Type), std::move(Default), argument(Call, Row, Row.Value)});
  });
  return R;
}

PreservedAnalyses ParamCallFinderPrinter::run(Module &M,
                                              ModuleAnalysisManager &AM) {
  const auto &R = AM.getResult<ParamCallFinder>(M);
  OS << "parameter reads of " << M.getName() << ": " << R.size() << '\n';
  for (const ParameterRead &Read : R)
    OS << "  " << Read.Row->Function << " '" << Read.Name << "' " << Read.Type
       << " default " << formatv("{0}", Read.Default) << " in "
       << Read.Call->getFunction()->getName() << place(*Read.Call) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
