//===- ParamCallFinder.cpp ------------------------------------------------===//
#include "params/ParamCallFinder.h"

#include "Options.h"
#include "params/ManyParameters.h"
#include "params/OtherNodes.h"
#include "params/ParameterObjects.h"
#include "params/Texts.h"
#include "results/Keys.h"
#include "support/Names.h"
#include "support/Print.h"
#include "support/SourcePath.h"

#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/FormatVariadic.h"

using namespace llvm;

namespace tpc {

AnalysisKey ParamCallFinder::Key;

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

json::Value jsonOf(const Constant &C, StringRef Type) {
  if (const auto *Int = dyn_cast<ConstantInt>(&C)) {
    if (Type == "bool" || Int->getBitWidth() == 1)
      return !Int->isZero();
    if (Int->getBitWidth() > 64)
      return nullptr;
    if (Type.starts_with("unsigned"))
      return Int->getZExtValue();
    return Int->getSExtValue();
  }
  if (const auto *Float = dyn_cast<ConstantFP>(&C)) {
    APFloat Value = Float->getValueAPF();
    bool Loses;
    Value.convert(APFloat::IEEEdouble(), APFloat::rmNearestTiesToEven, &Loses);
    // JSON has no infinity and no NaN.
    return Value.isFinite() ? json::Value(Value.convertToDouble())
                            : json::Value(nullptr);
  }
  return nullptr;
}

static json::Value defaultOf(const CallBase &Call, const Rule &R,
                             StringRef Type, Texts &Known) {
  const Value *V = argument(Call, R, R.Default);
  if (!V)
    return nullptr;
  if (Type == "std::string" || Type.contains("char ")) {
    std::string Text = Known.textAt(V, Call);
    return isDynamic(Text) ? json::Value(nullptr) : json::fixUTF8(Text);
  }
  const Constant *C = Known.constantOf(V);
  return C ? jsonOf(*C, Type) : nullptr;
}

/// The read of the one parameter that \p Call, described by \p Row, reads.
static ParameterRead readOf(CallBase &Call, const Rule &Row, Texts &Known) {
  std::string Type = valueType(*Call.getCalledFunction(), Row);
  json::Value Default = defaultOf(Call, Row, Type, Known);
  return {&Call,
          &Row,
          Known.nameOf(Call, Row),
          std::move(Type),
          std::move(Default),
          argument(Call, Row, Row.Value)};
}

static std::string keyOf(const ParameterRead &Read, const Options &Opts) {
  const DILocation *Loc = Read.Call->getDebugLoc();
  return Loc ? readKey(KeyParts::of(*Loc, Read.Name), Opts) : "";
}

ParamCallFinder::Result ParamCallFinder::run(Module &M,
                                             ModuleAnalysisManager &AM) {
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  Texts Known(Rules, AM.getResult<SimpleCallGraph>(M),
              Texts::MemoryView::of(M, AM));
  Result R;
  ManyParameters Many(M, AM, Known, R);
  OtherNodes Others(M, AM, Known);
  forEachCall(M, Rules, Rule::Read, [&](CallBase &Call, const Rule &Row) {
    const size_t Before = R.size();
    if (Row.Many != Rule::One)
      Many.add(Call, Row);
    else
      R.push_back(readOf(Call, Row, Known));
    if (Others.have(Call, Row))
      for (ParameterRead &Read : drop_begin(R, Before))
        Read.IsOfOther = true;
  });
  findAccessors(M, AM, Known, R);
  erase_if(R, [](const ParameterRead &Read) { return Read.IsOfOther; });
  findConfigs(M, AM, Known, R);
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  for (ParameterRead &Read : R)
    Read.Key = keyOf(Read, Opts);
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
