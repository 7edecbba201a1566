//===- Arguments.h - What a compiler is asked for ---------------*- C++ -*-===//
//
// Reads the arguments of a compiler as clang's driver does, as far as it takes
// to know whether it compiles, links or only answers a question.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_WRAPPER_ARGUMENTS_H
#define TPC_WRAPPER_ARGUMENTS_H

#include <string>
#include <vector>

namespace tpc {

/// How far the compiler goes.
enum class Step {
  Answer,  ///< no object is made: a question, -E, -S, -fsyntax-only, no input
  Compile, ///< -c, or a header is compiled in advance
  Link     ///< what is no source is linked, what is one is compiled before
};

/// What a source is, by -x or by its name.
enum class Language {
  CFamily,   ///< C, C++, Objective-C, and headers in them
  Assembler, ///< nothing of it passes through LLVM's passes
  Other,     ///< Fortran, CUDA, LLVM's own code, ...
  None       ///< an object, archive or library: for the linker
};

struct Input {
  std::string Path; ///< "-" is standard input
  Language Kind;
};

struct Arguments {
  Step Goal = Step::Answer;
  std::vector<Input> Inputs;
  std::string Output;         ///< -o; empty where there is none
  bool IsStatic = false;      ///< -static, -static-pie
  bool IsRelocatable = false; ///< -r
  bool AsksLinker = false;    ///< no more than which linker it is
  /// The first flag that does not go together with TPC; empty where none.
  std::string Obstacle;
  /// Number of the argument before which flags have to be added: that of "--",
  /// behind which nothing is a flag; else that behind the last.
  size_t End = 0;

  bool hasSource(Language Kind) const;
};

/// \p Words are those behind the program's name. Response files (`@file`) are
/// read as GNU's and clang's are.
Arguments parseArguments(const std::vector<std::string> &Words);

} // namespace tpc

#endif
