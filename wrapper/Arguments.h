//===- Arguments.h - What the compiler is asked to do -----------*- C++ -*-===//
//
// Reads the arguments of a compiler as clang's driver does, as far as needed to
// know whether it compiles, links or only answers a question.
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
  Compile, ///< -c, or a header is precompiled
  Link     ///< sources are compiled first, then everything is linked
};

/// The kind of a source, by -x or by its name.
enum class Language {
  CFamily,   ///< C, C++, Objective-C, and headers in them
  Assembler, ///< does not pass through LLVM's passes
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
  std::string Output;         ///< -o; empty if not given
  bool IsStatic = false;      ///< -static, -static-pie
  bool IsRelocatable = false; ///< -r
  bool AsksLinker = false;    ///< only asks which linker is used
  /// The first flag that TPC does not support; empty if there is none.
  std::string Obstacle;
  /// The number of the argument before which flags must be added: that of "--",
  /// after which nothing is a flag; otherwise the number of arguments.
  size_t End = 0;

  bool hasSource(Language Kind) const;
};

/// \p Words are the arguments without the program's name. Response files
/// (`@file`) are read as GNU's and clang's are.
Arguments parseArguments(const std::vector<std::string> &Words);

} // namespace tpc

#endif
