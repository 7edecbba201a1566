//===- Merger.cpp ---------------------------------------------------------===//
#include "merge/Merger.h"

#include "support/Functions.h"

#include "llvm/ADT/STLExtras.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/BinaryFormat/Magic.h"
#include "llvm/Bitcode/BitcodeReader.h"
#include "llvm/Demangle/Demangle.h"
#include "llvm/IR/DiagnosticInfo.h"
#include "llvm/IR/DiagnosticPrinter.h"
#include "llvm/IR/Instructions.h"
#include "llvm/Linker/Linker.h"
#include "llvm/Object/Archive.h"
#include "llvm/Passes/PassBuilder.h"
#include "llvm/Support/raw_ostream.h"
#include "llvm/Transforms/IPO/GlobalDCE.h"
#include "llvm/Transforms/IPO/Internalize.h"

using namespace llvm;

namespace tpc {

/// A unit while it is put together.
struct Merger::UnitModule {
  /// A member of an archive that is not linked yet.
  struct Member {
    std::string Name;
    MemoryBufferRef Buffer;
    std::vector<std::string> Defines;
  };

  UnitModule(const UnitFiles &Unit, LLVMContext &Ctx)
      : Name(Unit.Name), Code(std::make_unique<Module>(Unit.Name, Ctx)),
        Into(std::make_unique<Linker>(*Code)) {}

  StringRef Name;
  std::unique_ptr<Module> Code;
  std::unique_ptr<Linker> Into;
  std::vector<std::unique_ptr<MemoryBuffer>> Buffers;
  std::vector<std::unique_ptr<object::Archive>> Archives;
  std::vector<Member> Members;
};

Merger::Merger() : Process(std::make_unique<Module>("process", Ctx)) {
  Ctx.setDiagnosticHandlerCallBack(
      [](const DiagnosticInfo *Info, void *Of) {
        std::string &Text = static_cast<Merger *>(Of)->Complaint;
        raw_string_ostream OS(Text = "");
        DiagnosticPrinterRawOStream Printer(OS);
        Info->print(Printer);
      },
      this);
}

Merger::~Merger() = default;

void Merger::leaveOut(StringRef Unit, const Twine &File, std::string Why) {
  Missing.push_back({Unit.str(), File.str(), std::move(Why)});
}

/// The module in a file; null if it has none, which is then said.
std::unique_ptr<Module> Merger::read(const UnitModule &Of,
                                     MemoryBufferRef Buffer) {
  StringRef File = Buffer.getBufferIdentifier();
  if (identify_magic(Buffer.getBuffer()) != file_magic::bitcode) {
    leaveOut(Of.Name, File, "no bitcode");
    return nullptr;
  }
  Expected<std::unique_ptr<Module>> Read = getLazyBitcodeModule(Buffer, Ctx);
  if (Read)
    return std::move(*Read);
  leaveOut(Of.Name, File, toString(Read.takeError()));
  return nullptr;
}

bool Merger::link(UnitModule &To, std::unique_ptr<Module> From) {
  std::string File = From->getModuleIdentifier();
  if (!To.Into->linkInModule(std::move(From)))
    return true;
  leaveOut(To.Name, File, Complaint);
  return false;
}

void Merger::addFile(UnitModule &To, const UnitFiles::File &File) {
  auto Opened = MemoryBuffer::getFile(File.Path, /*IsText=*/false,
                                      /*RequiresNullTerminator=*/false);
  if (!Opened) {
    leaveOut(To.Name, File.Path, Opened.getError().message());
    return;
  }
  MemoryBufferRef Buffer = (*Opened)->getMemBufferRef();
  To.Buffers.push_back(std::move(*Opened));
  if (identify_magic(Buffer.getBuffer()) != file_magic::archive) {
    if (std::unique_ptr<Module> Code = read(To, Buffer))
      link(To, std::move(Code));
    return;
  }
  Expected<std::unique_ptr<object::Archive>> Archive =
      object::Archive::create(Buffer);
  if (!Archive) {
    leaveOut(To.Name, File.Path, toString(Archive.takeError()));
    return;
  }
  Error Bad = Error::success();
  for (const object::Archive::Child &Child : (*Archive)->children(Bad)) {
    Expected<MemoryBufferRef> Content = Child.getMemoryBufferRef();
    if (!Content) {
      leaveOut(To.Name, File.Path, toString(Content.takeError()));
      continue;
    }
    std::string Name =
        (File.Path + "(" + Content->getBufferIdentifier() + ")").str();
    std::unique_ptr<Module> Code =
        read(To, MemoryBufferRef(Content->getBuffer(), Name));
    if (!Code)
      continue;
    Code->setModuleIdentifier(Name);
    if (File.Whole) {
      link(To, std::move(Code));
      continue;
    }
    UnitModule::Member Member{std::move(Name), *Content, {}};
    for (const GlobalValue &V : Code->global_values())
      if (!V.isDeclarationForLinker() && !V.hasLocalLinkage())
        Member.Defines.push_back(V.getName().str());
    To.Members.push_back(std::move(Member));
  }
  if (Bad)
    leaveOut(To.Name, File.Path, toString(std::move(Bad)));
  To.Archives.push_back(std::move(*Archive));
}

/// Links the members of archives that define what is still undefined.
void Merger::addNeededMembers(UnitModule &To) {
  bool Again = true;
  while (Again) {
    Again = false;
    for (size_t N = 0; N < To.Members.size(); ++N) {
      bool IsNeeded = any_of(To.Members[N].Defines, [&](StringRef Name) {
        const GlobalValue *V = To.Code->getNamedValue(Name);
        return V && V->isDeclarationForLinker() && !V->hasExternalWeakLinkage();
      });
      if (!IsNeeded)
        continue;
      UnitModule::Member Member = std::move(To.Members[N]);
      To.Members.erase(To.Members.begin() + static_cast<ptrdiff_t>(N--));
      std::unique_ptr<Module> Code =
          read(To, MemoryBufferRef(Member.Buffer.getBuffer(), Member.Name));
      Code->setModuleIdentifier(Member.Name);
      Again |= link(To, std::move(Code));
    }
  }
}

/// Makes \p V, a definition, the declaration of what another unit defines.
static void makeDeclaration(GlobalValue &V) {
  if (auto *F = dyn_cast<Function>(&V)) {
    F->deleteBody();
    F->setComdat(nullptr);
  } else if (auto *Variable = dyn_cast<GlobalVariable>(&V)) {
    Variable->setInitializer(nullptr);
    Variable->setLinkage(GlobalValue::ExternalLinkage);
    Variable->setComdat(nullptr);
  } else {
    Module &M = *V.getParent();
    GlobalValue *Declared;
    if (auto *T = dyn_cast<FunctionType>(V.getValueType()))
      Declared = Function::Create(T, GlobalValue::ExternalLinkage,
                                  V.getAddressSpace(), "", &M);
    else
      Declared = new GlobalVariable(M, V.getValueType(), /*isConstant=*/false,
                                    GlobalValue::ExternalLinkage, nullptr);
    Declared->takeName(&V);
    V.replaceAllUsesWith(Declared);
    V.eraseFromParent();
  }
}

/// Prepares a unit for its place behind the others: what is visible in the unit
/// alone becomes local, and what an earlier unit defines is taken from there.
void Merger::giveWay(Module &Unit) {
  SmallVector<GlobalValue *, 0> Known;
  for (GlobalValue &V : Unit.global_values()) {
    if (V.isDeclarationForLinker() || V.hasLocalLinkage() ||
        V.hasAppendingLinkage())
      continue;
    if (!V.hasDefaultVisibility() && !V.hasProtectedVisibility()) {
      if (auto *Object = dyn_cast<GlobalObject>(&V))
        Object->setComdat(nullptr);
      V.setVisibility(GlobalValue::DefaultVisibility);
      V.setLinkage(GlobalValue::InternalLinkage);
      continue;
    }
    const GlobalValue *First = Process->getNamedValue(V.getName());
    if (First && !First->hasLocalLinkage() && !First->isDeclarationForLinker())
      Known.push_back(&V);
  }
  // Aliases first: what they lead to may become a declaration.
  for (GlobalValue *V : Known)
    if (!isa<GlobalObject>(V))
      makeDeclaration(*V);
  for (GlobalValue *V : Known)
    if (isa<GlobalObject>(V))
      makeDeclaration(*V);
}

void Merger::add(const UnitFiles &Unit) {
  UnitModule Code(Unit, Ctx);
  for (const UnitFiles::File &File : Unit.Files)
    addFile(Code, File);
  addNeededMembers(Code);
  std::vector<std::string> Names;
  for (Function &F : *Code.Code) {
    if (F.isDeclaration())
      continue;
    Names.push_back(F.getName().str());
    F.addFnAttr(UnitMark, Unit.Name);
    if (F.hasLocalLinkage() || F.hasHiddenVisibility())
      F.addFnAttr(LocalOf, (Unit.Name + ":" + F.getName()).str());
  }
  sort(Names);
  Functions.push_back(std::move(Names));
  giveWay(*Code.Code);
  if (Linker::linkModules(*Process, std::move(Code.Code)))
    leaveOut(Unit.Name, "", Complaint);
}

/// The class of the plugins that \p F, of class_loader, makes; empty if \p F is
/// another function. Of components it makes factories.
static std::string madeBy(const Function &F) {
  if (!F.getName().contains("MetaObject"))
    return "";
  std::string Text = demangle(F.getName());
  StringRef Name = Text;
  const size_t Begin = Name.find("::MetaObject<");
  if (Begin == StringRef::npos || !Name.ends_with("::create() const"))
    return "";
  StringRef Class = Name.drop_front(Begin).split('<').second;
  if (Class.consume_front("rclcpp_components::NodeFactoryTemplate<"))
    return Class.split('>').first.str();
  return Class.split(',').first.str();
}

void Merger::withoutPlugins(ArrayRef<std::string> Classes) {
  for (Function &F : *Process) {
    if (F.isDeclaration() || !is_contained(Classes, madeBy(F)))
      continue;
    F.deleteBody();
    F.setComdat(nullptr);
    new UnreachableInst(Ctx, BasicBlock::Create(Ctx, "", &F));
  }
}

/// The texts in \p M; what the program looks up by its name is among them.
static StringSet<> textsOf(const Module &M) {
  StringSet<> Texts;
  for (const GlobalVariable &V : M.globals())
    if (V.hasInitializer())
      if (const auto *Text =
              dyn_cast<ConstantDataSequential>(V.getInitializer());
          Text && Text->isCString())
        Texts.insert(Text->getAsCString());
  return Texts;
}

void Merger::removeUnreached() {
  const StringSet<> Texts = textsOf(*Process);
  internalizeModule(*Process, [&](const GlobalValue &V) {
    return V.getName() == "main" || Texts.contains(V.getName());
  });
  PassBuilder PB;
  ModuleAnalysisManager AM;
  PB.registerModuleAnalyses(AM);
  GlobalDCEPass().run(*Process, AM);
}

} // namespace tpc
