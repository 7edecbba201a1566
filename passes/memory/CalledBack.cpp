//===- CalledBack.cpp -----------------------------------------------------===//
#include "memory/CalledBack.h"

#include "support/Names.h"

#include "llvm/ADT/PointerIntPair.h"
#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

AnalysisKey CalledBackAnalysis::Key;

/// Limits the walk through nested classes. An object with more classes in it
/// can call anything.
static cl::opt<unsigned> MaxParts(
    "tpc-max-object-parts", cl::Hidden, cl::init(256),
    cl::desc(
        "Classes in an object that are searched for functions to call back"));

/// True for functions that only free, copy or log their arguments, or belong to
/// the language itself.
static bool callsNothing(StringRef Name) {
  return givesMemoryBack(Name) || Name.starts_with("_Znw") ||
         Name.starts_with("_Zna") || Name.starts_with("__") ||
         Name.starts_with("_ZN3ros7console") ||
         Name.starts_with("rcutils_log") || Name == "memcmp";
}

/// True if \p Class, of which only the name is known, may store functions. The
/// standard library's classes that do have it in their names.
static bool mayKeep(const DICompositeType &Class) {
  StringRef Name = Class.getIdentifier();
  bool IsStandard = Name.consume_front("_ZTS") &&
                    (Name.starts_with("St") || Name.starts_with("Sa") ||
                     Name.starts_with("NSt"));
  return !IsStandard || Name.contains("function") || Name.contains("PF");
}

const ClassHierarchy &CalledBack::classes() {
  if (!Classes)
    Classes.emplace(M);
  return *Classes;
}

/// Adds the virtual functions of \p Class and of all derived classes.
void CalledBack::addClass(const DICompositeType &Class, Callable &Out) {
  StringRef Name = Class.getIdentifier();
  if (!Name.consume_front("_ZTS")) {
    Out.Unknown |= Class.getVTableHolder() != nullptr;
    return;
  }
  classes().addFunctions(Name, Out.Virtual);
}

const CalledBack::Callable &CalledBack::ofType(const DIType *T) {
  std::unique_ptr<Callable> &Out = ByType[T];
  if (Out)
    return *Out;
  Out = std::make_unique<Callable>();
  // Types, and whether each is only the base class of an earlier one.
  SmallSetVector<PointerIntPair<const DIType *, 1, bool>, 16> Work;
  auto Add = [&](const DIType *Inner, bool AsBase = false) {
    if (const DIType *Plain = DebugTypes::plain(Inner))
      Work.insert({Plain, AsBase});
  };
  Add(T);
  for (unsigned N = 0; N < Work.size(); ++N) {
    const DIType *Part = Work[N].getPointer();
    bool IsBase = Work[N].getInt();
    if (Work.size() > MaxParts) {
      Out->Unknown = true;
      break;
    }
    Out->Kept |= isa<DISubroutineType>(Part);
    if (const auto *Pointer = dyn_cast<DIDerivedType>(Part))
      if (isa_and_nonnull<DISubroutineType>(
              DebugTypes::plain(Pointer->getBaseType())))
        Out->Kept = true;
    const auto *Class = dyn_cast<DICompositeType>(Part);
    if (!Class)
      continue;
    Out->Kept |= Class->isForwardDecl() && mayKeep(*Class);
    if (Class->getTag() == dwarf::DW_TAG_array_type)
      Add(Class->getBaseType());
    else if (!IsBase)
      addClass(*Class, *Out);
    for (const DINode *Element : Class->getElements())
      if (const auto *Member = dyn_cast_or_null<DIDerivedType>(Element)) {
        bool AsBase = Member->getTag() == dwarf::DW_TAG_inheritance;
        if (AsBase || (Member->getTag() == dwarf::DW_TAG_member &&
                       !Member->isStaticMember()))
          Add(Member->getBaseType(), AsBase);
      }
    for (const DINode *Argument : Class->getTemplateParams())
      if (const auto *Type =
              dyn_cast_or_null<DITemplateTypeParameter>(Argument)) {
        const DIType *Pointee = DebugTypes::dereferenced(Type->getType());
        Add(Pointee ? Pointee : Type->getType());
      }
  }
  return *Out;
}

/// What can be called through the objects that \p F takes.
const CalledBack::Callable &CalledBack::ofParameters(const Function &F) {
  std::unique_ptr<Callable> &Out = ByFunction[&F];
  if (Out)
    return *Out;
  Out = std::make_unique<Callable>();
  StringRef Name = F.getName();
  // A C function gets functions by their addresses.
  if (!Name.starts_with("_Z"))
    return *Out;
  Out->Kept = Name.contains("function") || Name.contains("PF");
  classes().addFunctionsOfNamed(Name, Out->Virtual);
  return *Out;
}

/// True if \p Call calls a function without a body that may call others.
static bool mayCallBack(const CallBase &Call) {
  const Function *Callee = Call.getCalledFunction();
  return Callee && Callee->isDeclarationForLinker() && !Callee->isIntrinsic() &&
         !callsNothing(Callee->getName());
}

const CalledBack::Callable *CalledBack::handedAs(const CallBase &Call,
                                                 const Use &Arg) {
  if (!Arg->getType()->isPointerTy() || isa<ConstantPointerNull>(Arg) ||
      !mayCallBack(Call))
    return nullptr;
  const DIType *T = Debug.pointee(Arg);
  return T ? &ofType(T) : &ofParameters(*Call.getCalledFunction());
}

SmallVector<const CalledBack::Callable *, 2>
CalledBack::handedBy(const CallBase &Call) {
  SmallVector<const Callable *, 2> Found;
  for (const Use &Arg : Call.args())
    if (const Callable *Object = handedAs(Call, Arg))
      Found.push_back(Object);
  return Found;
}

} // namespace tpc
