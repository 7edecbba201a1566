//===- DebugTypes.cpp -----------------------------------------------------===//
#include "support/DebugTypes.h"

#include "support/Compat.h"
#include "support/Names.h"
#include "support/SourcePath.h"

#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey DebugTypesAnalysis::Key;

DebugTypes DebugTypesAnalysis::run(Module &M, ModuleAnalysisManager &) {
  return DebugTypes(M.getDataLayout());
}

const DISubprogram *virtualIn(const DICompositeType &Class, unsigned Slot) {
  for (const DINode *N : Class.getElements())
    // A destructor, which has two slots, has the number 0 here.
    if (const auto *Method = dyn_cast_or_null<DISubprogram>(N);
        Method && Method->getVirtuality() &&
        Method->getVirtualIndex() == Slot &&
        !Method->getName().starts_with("~"))
      return Method;
  return nullptr;
}

bool isSmartPointer(const DIType *T) {
  StringRef Name = T ? T->getName().split('<').first : "";
  return Name == "shared_ptr" || Name == "unique_ptr";
}

std::optional<uint64_t> borrowedAt(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(T);
  if (!Class || !Class->getName().starts_with("LoanedMessage<"))
    return std::nullopt;
  for (const DINode *Element : Class->getElements())
    if (const auto *Field = dyn_cast_or_null<DIDerivedType>(Element);
        Field && Field->getTag() == dwarf::DW_TAG_member &&
        Field->getName() == "message_")
      return Field->getOffsetInBits() / CHAR_BIT;
  return std::nullopt;
}

const DIType *firstArgumentOf(const DICompositeType &Class) {
  for (const DITemplateParameter *P : Class.getTemplateParams())
    return P ? P->getType() : nullptr;
  return nullptr;
}

bool pointsToConst(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(T);
  if (!Class || !isSmartPointer(Class))
    return false;
  const DIType *Of = firstArgumentOf(*Class);
  for (; isa_and_nonnull<DIDerivedType>(Of);
       Of = cast<DIDerivedType>(Of)->getBaseType())
    if (Of->getTag() == dwarf::DW_TAG_const_type)
      return true;
  return false;
}

const DIType *DebugTypes::plain(const DIType *T) {
  while (const auto *Derived = dyn_cast_or_null<DIDerivedType>(T)) {
    switch (Derived->getTag()) {
    case dwarf::DW_TAG_typedef:
    case dwarf::DW_TAG_const_type:
    case dwarf::DW_TAG_volatile_type:
      T = Derived->getBaseType();
      continue;
    default:
      return T;
    }
  }
  return T;
}

const DIType *DebugTypes::dereferenced(const DIType *T) {
  const auto *Derived = dyn_cast_or_null<DIDerivedType>(plain(T));
  if (!Derived)
    return nullptr;
  switch (Derived->getTag()) {
  case dwarf::DW_TAG_pointer_type:
  case dwarf::DW_TAG_reference_type:
  case dwarf::DW_TAG_rvalue_reference_type:
    return plain(Derived->getBaseType());
  default:
    return nullptr;
  }
}

/// The element type of an array of any dimension; otherwise \p T.
static const DIType *element(const DIType *T) {
  T = DebugTypes::plain(T);
  const auto *Array = dyn_cast_or_null<DICompositeType>(T);
  return Array && Array->getTag() == dwarf::DW_TAG_array_type
             ? DebugTypes::plain(Array->getBaseType())
             : T;
}

const DIDerivedType *DebugTypes::memberAt(const DICompositeType *Class,
                                          uint64_t Bits) const {
  for (const DINode *N : Class->getElements()) {
    const auto *Member = dyn_cast_or_null<DIDerivedType>(N);
    if (!Member || Member->isStaticMember() ||
        Member->getOffsetInBits() != Bits)
      continue;
    // An empty base class shares its offset with the next member.
    const auto *Base = dyn_cast_or_null<DICompositeType>(
        Member->getTag() == dwarf::DW_TAG_inheritance
            ? plain(Member->getBaseType())
            : nullptr);
    if (Member->getTag() == dwarf::DW_TAG_member ||
        (Base && Base->getSizeInBits() > 8))
      return Member;
  }
  return nullptr;
}

/// True if \p Class and \p Struct have the same name, ignoring scopes.
static bool isNamedAs(const DICompositeType &Class, const StructType &Struct) {
  StringRef Name = plainClassName(Struct).rsplit(':').second;
  if (Name.empty())
    Name = plainClassName(Struct);
  return Class.getName().split('<').first == Name;
}

const DICompositeType *DebugTypes::asStruct(const DIType *T,
                                            StructType *Struct) {
  auto [It, New] = Structs.try_emplace({T, Struct}, nullptr);
  if (New)
    It->second = findStruct(T, Struct);
  return It->second;
}

bool DebugTypes::mayContain(const DIType *T, unsigned Inner) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(element(T));
  if (!T || !Inner)
    return true;
  if (!Class)
    return false;
  auto [It, New] = Contained.try_emplace({Class, Inner}, false);
  if (!New)
    return It->second;
  // Of the standard library's templates, only the declaration may be known.
  bool May = numberOf(Class) == Inner;
  if (!May && Class->isForwardDecl())
    May = !Class->getName().starts_with("basic_string<");
  for (const DINode *N : Class->getElements()) {
    const auto *Member = dyn_cast_or_null<DIDerivedType>(N);
    if (!May && Member && !Member->isStaticMember() &&
        (Member->getTag() == dwarf::DW_TAG_member ||
         Member->getTag() == dwarf::DW_TAG_inheritance))
      May = mayContain(Member->getBaseType(), Inner);
  }
  return Contained[{Class, Inner}] = May;
}

const DICompositeType *DebugTypes::findStruct(const DIType *T,
                                              StructType *Struct) const {
  uint64_t Bits = Struct->isSized()
                      ? Layout.getTypeAllocSize(Struct).getFixedValue() * 8
                      : 0;
  // `class.A.base` is A without the padding at its end.
  bool Unpadded = Struct->hasName() && Struct->getName().contains(".base");
  const DICompositeType *Fits = nullptr;
  const auto *Class = dyn_cast_or_null<DICompositeType>(element(T));
  while (Class) {
    uint64_t Size = Class->getSizeInBits();
    if (Size == Bits || (Unpadded && Size >= Bits && Size < Bits + 64)) {
      // If possible, the name decides; the linker may have merged the type with
      // that of another class that looks alike.
      if (isNamedAs(*Class, *Struct))
        return Class;
      if (!Fits)
        Fits = Class;
    }
    const DIDerivedType *First = memberAt(Class, 0);
    Class =
        First ? dyn_cast_or_null<DICompositeType>(element(First->getBaseType()))
              : nullptr;
  }
  return Fits;
}

/// `ns::Outer::Class` for \p Class, without template arguments, as clang names
/// its type.
static std::string scopedName(const DICompositeType &Class) {
  std::string Name = Class.getName().split('<').first.str();
  for (const DIScope *S = Class.getScope(); S; S = S->getScope()) {
    if (!isa<DINamespace, DICompositeType>(S))
      break;
    StringRef Own = S->getName().split('<').first;
    Name = (Own.empty() ? "(anonymous namespace)" : Own).str() + "::" + Name;
  }
  return Name;
}

StructType *DebugTypes::classOf(const GlobalVariable &Global,
                                ArrayRef<StructType *> All) {
  uint64_t Size = Layout.getTypeAllocSize(Global.getValueType());
  // If no code accesses the members of a class, the module only has the type of
  // its base class.
  const auto *Class = dyn_cast_or_null<DICompositeType>(pointee(&Global));
  while (Class && Class->getSizeInBits() == Size * 8) {
    std::string Name = scopedName(*Class);
    for (StructType *T : All)
      if (T->isSized() && Layout.getTypeAllocSize(T) == Size &&
          plainClassName(*T) == Name)
        return T;
    const DIDerivedType *First = memberAt(Class, 0);
    Class = First
                ? dyn_cast_or_null<DICompositeType>(plain(First->getBaseType()))
                : nullptr;
  }
  return nullptr;
}

const DIType *DebugTypes::field(const DICompositeType *Class,
                                StructType *Struct, unsigned Index) const {
  // A class without its padding may occur in place of the padded one.
  if (!Class || !Struct->isSized() || Index >= Struct->getNumElements())
    return nullptr;
  const DIDerivedType *Member = memberAt(
      Class, Layout.getStructLayout(Struct)->getElementOffsetInBits(Index));
  return Member ? plain(Member->getBaseType()) : nullptr;
}

bool DebugTypes::isConst(const DICompositeType *Class, StructType *Struct,
                         unsigned Index) const {
  if (!Class || !Struct->isSized() || Index >= Struct->getNumElements())
    return false;
  const DIDerivedType *Member = memberAt(
      Class, Layout.getStructLayout(Struct)->getElementOffsetInBits(Index));
  const DIType *T = Member ? Member->getBaseType() : nullptr;
  return T && T->getTag() == dwarf::DW_TAG_const_type;
}

StringRef DebugTypes::fieldName(const DICompositeType *Class,
                                StructType *Struct, unsigned Index) const {
  if (Index >= Struct->getNumElements())
    return "";
  const DIDerivedType *Member = memberAt(
      Class, Layout.getStructLayout(Struct)->getElementOffsetInBits(Index));
  return Member && Member->getTag() == dwarf::DW_TAG_member ? Member->getName()
                                                            : "";
}

/// Where a C struct at file scope is declared; otherwise empty. In C++ it also
/// has an identifier.
static std::string declaredAt(const DICompositeType &Class) {
  if (!Class.getFile() || !Class.getLine() ||
      !isa_and_nonnull<DIFile>(Class.getScope() ? Class.getScope()
                                                : Class.getFile()))
    return "";
  return (pathOf(Class.getFile()) + ":" + Twine(Class.getLine()) + ":" +
          Class.getName() + ":" + Twine(Class.getSizeInBits()))
      .str();
}

std::string DebugTypes::identifierOf(const DICompositeType &Class) {
  // Clang omits the identifier in the file that has the vtable of the class,
  // which is the file of its first virtual function that is not inline. An
  // instance of a template has no such file.
  if (!Class.getIdentifier().empty() || !Class.getVTableHolder())
    return Class.getIdentifier().str();
  std::string Name;
  unsigned Depth = 0;
  for (const DIScope *S = &Class; S && !isa<DIFile>(S); S = S->getScope()) {
    StringRef Own = S->getName();
    if (!isa<DINamespace, DICompositeType>(S) || Own.empty() ||
        Own.contains('<'))
      return "";
    Name = (Twine(Own.size()) + Own + Name).str();
    ++Depth;
  }
  return Depth == 1 ? "_ZTS" + Name : "_ZTSN" + Name + "E";
}

unsigned DebugTypes::numberOf(const DICompositeType *Class) {
  if (!Class)
    return 0;
  unsigned &Number = Numbers[Class];
  if (Number)
    return Number;
  // A class that exists across files has an identifier. A C struct has none; it
  // is the same if the same header declares it.
  SmallVector<StringRef, 2> Names;
  const std::string Identifier = identifierOf(*Class),
                    Place = declaredAt(*Class);
  for (StringRef Name : {StringRef(Identifier), StringRef(Place)})
    if (!Name.empty())
      Names.push_back(Name);
  for (StringRef Name : Names)
    if (!Number)
      Number = ByName.lookup(Name);
  if (!Number) {
    Classes.push_back(Class);
    Number = Classes.size();
  }
  for (StringRef Name : Names)
    ByName.try_emplace(Name, Number);
  return Number;
}

const DIType *DebugTypes::declared(const Argument &Arg) {
  const Function *F = Arg.getParent();
  const DISubprogram *SP = F->getSubprogram();
  if (!SP || !SP->getType())
    return nullptr;
  DITypeRefArray Types = SP->getType()->getTypeArray();
  if (Arg.hasStructRetAttr())
    return Types.size() ? Types[0] : nullptr;
  unsigned Hidden = F->hasStructRetAttr() ? 1 : 0;
  // If objects are passed in registers, one takes several arguments and the
  // numbers do not match.
  if (Types.size() == 0 || F->arg_size() - Hidden != Types.size() - 1)
    return nullptr;
  return Types[Arg.getArgNo() - Hidden + 1];
}

const DIType *DebugTypes::ofArgument(const Argument &Arg) const {
  const DIType *T = plain(declared(Arg));
  // An object that cannot be copied byte by byte is passed by its address.
  bool IsObject = Arg.hasStructRetAttr() || Arg.hasByValAttr() ||
                  (T && (T->getFlags() & DINode::FlagTypePassByReference));
  return IsObject ? T : dereferenced(T);
}

const DIType *DebugTypes::ofElement(const GEPOperator &GEP) {
  const DIType *T = pointee(GEP.getPointerOperand());
  Type *Source = GEP.getSourceElementType();
  auto *Struct = dyn_cast<StructType>(Source);
  if (!T || (Struct && Struct->isLiteral()))
    return nullptr;
  if (Source->isIntegerTy(8)) {
    APInt Bytes(Layout.getIndexTypeSizeInBits(GEP.getType()), 0);
    const auto *Class = dyn_cast<DICompositeType>(T);
    if (!Class || !GEP.accumulateConstantOffset(Layout, Bytes))
      return nullptr;
    const DIDerivedType *Member = memberAt(Class, Bytes.getZExtValue() * 8);
    return Member ? plain(Member->getBaseType()) : nullptr;
  }
  for (const Use &U : drop_begin(GEP.indices())) {
    if (auto *S = dyn_cast<StructType>(Source)) {
      unsigned Index = cast<ConstantInt>(U.get())->getZExtValue();
      T = field(asStruct(T, S), S, Index);
    } else {
      T = element(T);
    }
    Source = GetElementPtrInst::getTypeAtIndex(Source, U.get());
  }
  return T;
}

/// The scalar at the beginning of an object of type \p T.
const DIType *DebugTypes::firstScalar(const DIType *T) const {
  T = element(T);
  for (unsigned Depth = 0; Depth < 16; ++Depth) {
    const auto *Class = dyn_cast_or_null<DICompositeType>(T);
    const DIDerivedType *First = Class ? memberAt(Class, 0) : nullptr;
    if (!First)
      break;
    T = element(First->getBaseType());
  }
  return T;
}

/// The type of \p Local, which is not a variable of the source, according to
/// the functions that get a pointer to it, inlined or not: a class with its
/// name, otherwise with its size.
const DIType *DebugTypes::ofTemporary(const AllocaInst &Local) {
  auto *Struct = dyn_cast<StructType>(Local.getAllocatedType());
  if (!Struct)
    return nullptr;
  const DICompositeType *Fits = nullptr;
  // True if the name matches.
  auto Take = [&](const DIType *T) {
    const DICompositeType *Class = asStruct(T, Struct);
    // A base class is not the whole object.
    if (!Class || Class != T)
      return false;
    bool IsNamed = isNamedAs(*Class, *Struct);
    if (!Fits || IsNamed)
      Fits = Class;
    return IsNamed;
  };
  for (DbgVariableRecord *R : variableRecords(const_cast<AllocaInst *>(&Local)))
    if (R->isDbgValue() && R->getExpression()->getNumElements() == 0 &&
        Take(dereferenced(R->getVariable()->getType())))
      return Fits;
  for (const Use &U : Local.uses()) {
    const auto *Call = dyn_cast<CallBase>(U.getUser());
    const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
    if (Callee && Call->isArgOperand(&U) &&
        Call->getArgOperandNo(&U) < Callee->arg_size() &&
        Take(ofArgument(*Callee->getArg(Call->getArgOperandNo(&U)))))
      return Fits;
  }
  return Fits;
}

const DIType *DebugTypes::find(const Value *Pointer) {
  if (const auto *Arg = dyn_cast<Argument>(Pointer))
    return ofArgument(*Arg);
  if (const auto *GEP = dyn_cast<GEPOperator>(Pointer))
    return ofElement(*GEP);
  if (const auto *Local = dyn_cast<AllocaInst>(Pointer)) {
    for (DbgVariableRecord *R :
         findDVRDeclares(const_cast<AllocaInst *>(Local)))
      return plain(R->getVariable()->getType());
    return ofTemporary(*Local);
  }
  if (const auto *F = dyn_cast<Function>(Pointer))
    return F->getSubprogram() ? F->getSubprogram()->getType() : nullptr;
  if (const auto *Global = dyn_cast<GlobalVariable>(Pointer)) {
    SmallVector<DIGlobalVariableExpression *, 1> Infos;
    Global->getDebugInfo(Infos);
    return Infos.empty() ? nullptr
                         : plain(Infos.front()->getVariable()->getType());
  }
  if (const auto *Load = dyn_cast<LoadInst>(Pointer)) {
    // The pointer that is loaded is the scalar at the beginning of the object.
    return dereferenced(firstScalar(pointee(Load->getPointerOperand())));
  }
  if (const auto *Call = dyn_cast<CallBase>(Pointer)) {
    // The call of `new` is annotated with the type.
    if (const auto *Made =
            dyn_cast_or_null<DIType>(Call->getMetadata("heapallocsite")))
      return plain(Made);
    const Function *Callee = Call->getCalledFunction();
    const DISubprogram *SP = Callee ? Callee->getSubprogram() : nullptr;
    if (!SP || !SP->getType() || SP->getType()->getTypeArray().size() == 0)
      return nullptr;
    // An iterator may be returned as the pointer inside it.
    return dereferenced(firstScalar(SP->getType()->getTypeArray()[0]));
  }
  if (const auto *Phi = dyn_cast<PHINode>(Pointer)) {
    for (const Value *V : Phi->incoming_values())
      if (const DIType *T = pointee(V))
        return T;
    return nullptr;
  }
  if (const auto *Select = dyn_cast<SelectInst>(Pointer))
    return pointee(Select->getTrueValue());
  return nullptr;
}

const DIType *DebugTypes::pointee(const Value *Pointer) {
  // A cycle finds null here and is ignored.
  auto [It, New] = Known.try_emplace(Pointer, nullptr);
  if (!New)
    return It->second;
  const DIType *T = find(Pointer);
  return Known[Pointer] = T;
}

} // namespace tpc
