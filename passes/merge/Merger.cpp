//===- Merger.cpp ---------------------------------------------------------===//
#include "merge/Merger.h"

#include "merge/Symbols.h"
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
#include "llvm/Object/ObjectFile.h"
#include "llvm/Passes/PassBuilder.h"
#include "llvm/Support/StringSaver.h"
#include "llvm/Support/raw_ostream.h"
#include "llvm/Transforms/IPO/GlobalDCE.h"
#include "llvm/Transforms/IPO/Internalize.h"

using namespace llvm;

namespace tpc {

namespace {

/// The names that an object defines for other files. One without bitcode has
/// also those that it takes from them: of the others, the module says so.
struct NamesOfObject {
  std::vector<std::string> Defined, Taken;
};

} // namespace

/// Whether it is bitcode.
static bool isBitcode(MemoryBufferRef Buffer) {
  return identify_magic(Buffer.getBuffer()) == file_magic::bitcode;
}

static NamesOfObject namesInBitcode(MemoryBufferRef Buffer) {
  NamesOfObject Names;
  LLVMContext Ctx; // not that of what is linked
  Expected<std::unique_ptr<Module>> Code = getLazyBitcodeModule(Buffer, Ctx);
  if (!Code) {
    consumeError(Code.takeError()); // said when it is read
    return Names;
  }
  for (const GlobalValue &V : (*Code)->global_values())
    if (!V.isDeclarationForLinker() && !V.hasLocalLinkage())
      Names.Defined.push_back(V.getName().str());
  return Names;
}

static NamesOfObject namesInNative(MemoryBufferRef Buffer) {
  NamesOfObject Names;
  auto Object = object::ObjectFile::createELFObjectFile(Buffer);
  if (!Object) {
    consumeError(Object.takeError());
    return Names;
  }
  using object::SymbolRef;
  for (const SymbolRef &Each : (*Object)->symbols()) {
    Expected<uint32_t> Flags = Each.getFlags();
    Expected<StringRef> Name = Each.getName();
    if (!Flags || !Name) {
      consumeError(joinErrors(Flags.takeError(), Name.takeError()));
      continue;
    }
    if (!(*Flags & SymbolRef::SF_Global))
      continue;
    if (!(*Flags & SymbolRef::SF_Undefined))
      Names.Defined.push_back(Name->str());
    else if (!(*Flags & SymbolRef::SF_Weak))
      Names.Taken.push_back(Name->str());
  }
  return Names;
}

/// A unit while it is put together.
struct Merger::UnitModule {
  /// An object that is not linked yet.
  struct Member {
    MemoryBufferRef Buffer;
    NamesOfObject Names;
  };

  /// True if an object is linked that takes \p Name, and none that defines it.
  bool needs(StringRef Name) const {
    const GlobalValue *V = Code->getNamedValue(Name);
    if (Known.contains(Name) || (V && !V->isDeclarationForLinker()))
      return false;
    return Wanted.contains(Name) || (V && !V->hasExternalWeakLinkage());
  }

  UnitModule(const UnitFiles &Unit, LLVMContext &Ctx)
      : Name(Unit.Name), Code(std::make_unique<Module>(Unit.Name, Ctx)),
        Into(std::make_unique<Linker>(*Code)) {}

  StringRef Name;
  std::unique_ptr<Module> Code;
  std::unique_ptr<Linker> Into;
  std::vector<std::unique_ptr<MemoryBuffer>> Buffers;
  std::vector<std::unique_ptr<object::Archive>> Archives;
  std::vector<Member> Members;
  StringSet<> Known, Wanted; ///< what code without bitcode defines and takes
  BumpPtrAllocator Memory;
  StringSaver Names{Memory};
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
  if (!isBitcode(Buffer)) {
    leaveOut(Of.Name, File, "has no bitcode");
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
  if (identify_magic(Buffer.getBuffer()) == file_magic::archive)
    addArchive(To, File, Buffer);
  else
    addObject(To, Buffer, File.Lazy);
}

void Merger::addArchive(UnitModule &To, const UnitFiles::File &File,
                        MemoryBufferRef Buffer) {
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
    StringRef Name =
        To.Names.save(File.Path + "(" + Content->getBufferIdentifier() + ")");
    addObject(To, MemoryBufferRef(Content->getBuffer(), Name), !File.Whole);
  }
  if (Bad)
    leaveOut(To.Name, File.Path, toString(std::move(Bad)));
  To.Archives.push_back(std::move(*Archive));
}

/// Links an object; if it \p IsLazy, it waits until it is needed.
void Merger::addObject(UnitModule &To, MemoryBufferRef Buffer, bool IsLazy) {
  if (IsLazy) {
    To.Members.push_back({Buffer, isBitcode(Buffer) ? namesInBitcode(Buffer)
                                                    : namesInNative(Buffer)});
    return;
  }
  if (!isBitcode(Buffer)) {
    const NamesOfObject Names = namesInNative(Buffer);
    To.Known.insert(Names.Defined.begin(), Names.Defined.end());
    To.Wanted.insert(Names.Taken.begin(), Names.Taken.end());
  }
  if (std::unique_ptr<Module> Code = read(To, Buffer))
    link(To, std::move(Code));
}

/// Links the members of archives, and the other files that wait, that define
/// what is still undefined.
void Merger::addNeededMembers(UnitModule &To) {
  bool Again = true;
  while (Again) {
    Again = false;
    for (size_t N = 0; N < To.Members.size(); ++N) {
      if (none_of(To.Members[N].Names.Defined,
                  [&](StringRef Name) { return To.needs(Name); }))
        continue;
      UnitModule::Member Member = std::move(To.Members[N]);
      To.Members.erase(To.Members.begin() + static_cast<ptrdiff_t>(N--));
      addObject(To, Member.Buffer, /*IsLazy=*/false);
      Again = true;
    }
  }
}

/// Makes local what is visible in the unit alone.
static void hide(Module &Unit) {
  for (GlobalValue &V : Unit.global_values()) {
    if (V.isDeclarationForLinker() || V.hasLocalLinkage() ||
        V.hasAppendingLinkage() || V.hasDefaultVisibility() ||
        V.hasProtectedVisibility())
      continue;
    if (auto *Object = dyn_cast<GlobalObject>(&V))
      Object->setComdat(nullptr);
    V.setVisibility(GlobalValue::DefaultVisibility);
    V.setLinkage(GlobalValue::InternalLinkage);
  }
}

void Merger::add(const UnitFiles &Unit) {
  Units.push_back(std::make_unique<UnitModule>(Unit, Ctx));
  UnitModule &Code = *Units.back();
  // What starts a program calls it.
  if (Units.size() == 1)
    Code.Wanted.insert("main");
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
  hide(*Code.Code);
}

void Merger::join(ArrayRef<std::vector<std::string>> Scopes) {
  std::vector<Symbols::Unit> All;
  for (const std::unique_ptr<UnitModule> &Each : Units)
    All.push_back({Each->Name, *Each->Code});
  Symbols Chosen(std::move(All), Scopes);
  Chosen.choose();
  Renamed = Chosen.renamed();
  for (const std::unique_ptr<UnitModule> &Each : Units)
    if (Linker::linkModules(*Process, std::move(Each->Code)))
      leaveOut(Each->Name, "", Complaint);
  Units.clear();
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
    auto It = Renamed.find(V.getName());
    StringRef Name = It == Renamed.end() ? V.getName() : StringRef(It->second);
    return Name == "main" || Texts.contains(Name);
  });
  PassBuilder PB;
  ModuleAnalysisManager AM;
  PB.registerModuleAnalyses(AM);
  GlobalDCEPass().run(*Process, AM);
}

} // namespace tpc
