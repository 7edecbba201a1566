# Builds a package with the passes of TPC. One file with three entrances:
#
#   -DCMAKE_TOOLCHAIN_FILE=.../tpc.cmake   what `pytpc build` does
#   -DCMAKE_PROJECT_INCLUDE=.../tpc.cmake  with the compilers chosen elsewhere
#   include(.../tpc.cmake)                 at the top of a CMakeLists.txt, as
#                                          `python -m pytpc.workspace.patch` puts it there
#
# Before project() it chooses the compilers; after it, it adds the flags to the
# rules by which CMake compiles and links. What it cannot do it says in one
# warning, and leaves the build as it would have been.
#
#   TPC_CLANG_VERSION  release of clang, lld and LLVM (19)
#   TPC_RULES          the user's own file of rules
#   TPC_PROFILE        thesis or default
#   TPC_MAX_SECONDS    processor time that the analysis of a link unit may take (120)
#   TPC_MAX_MEMORY     MiB that it may take (4096)
#   TPC_CONSTANTS      report comparisons with constants of the source, too
#   TPC_TESTS          have test programs analysed and reporting, too
#   TPC_DISABLE        leave this package alone
#   TPC_LEFT_ALONE     a list of folders of packages that are left alone, compiler and all
#
# A target's property TPC_INSTRUMENT, set to OFF, keeps the reports out of it; set to
# ON it has them put into a test program. What is worked out for each target stands
# in tpc-targets.cmake.

cmake_policy(PUSH)
cmake_policy(VERSION 3.16)
include("${CMAKE_CURRENT_LIST_DIR}/tpc-compilers.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/tpc-targets.cmake")

set(_tpc_file "${CMAKE_CURRENT_LIST_FILE}")
get_filename_component(_tpc_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(_tpc_plugin "${_tpc_prefix}/lib/tpc/TpcPasses.so")
set(_tpc_defer "${_tpc_prefix}/lib/tpc/TpcDefer.so")
set(_tpc_log "${_tpc_prefix}/lib/libtpc_log.so")
set(_tpc_flags_file "${_tpc_prefix}/share/tpc/flags")
if(NOT TPC_CLANG_VERSION)
  set(TPC_CLANG_VERSION 19)
endif()
# Sets `text` to the flags of one kind in share/tpc/flags, as a shell reads them. What they
# are for is said there.
function(_tpc_read_flags kind text)
  set(read "")
  if(EXISTS "${_tpc_flags_file}")
    file(STRINGS "${_tpc_flags_file}" flags REGEX "^${kind} ")
    foreach(flag IN LISTS flags)
      string(REPLACE " " ";" words "${flag}")
      list(REMOVE_AT words 0)
      foreach(word IN LISTS words)
        string(REPLACE "@PREFIX@" "${_tpc_prefix}" placed "${word}")
        string(REPLACE "@LLD@" "${TPC_LLD}" placed "${placed}")
        if(NOT placed STREQUAL word)
          set(placed "\"${placed}\"")
        endif()
        string(APPEND read " ${placed}")
      endforeach()
    endforeach()
  endif()
  set(${text} "${read}" PARENT_SCOPE)
endfunction()

# See _tpc_instrument.
set(_tpc_defer_hash "")
if(EXISTS "${_tpc_defer}")
  file(SHA256 "${_tpc_defer}" _tpc_defer_hash)
  string(SUBSTRING "${_tpc_defer_hash}" 0 8 _tpc_defer_hash)
endif()
_tpc_read_flags(compile _tpc_compile_flags)
_tpc_read_flags(accept _tpc_accept_flags)
string(APPEND _tpc_compile_flags "${_tpc_accept_flags}")

# Has what is linked from these languages linked by lld, the probes included:
# a static library of a package below holds bitcode. It stands in the rules
# because CMAKE_EXE_LINKER_FLAGS is for all languages, and gfortran and nvcc do
# not know these flags; and because packages overwrite that variable.
macro(_tpc_link_with_lld)
  _tpc_read_flags(link _tpc_link_flags)
  foreach(_tpc_language ${ARGN})
    _tpc_add_link_flags(${_tpc_language} "${_tpc_link_flags}")
  endforeach()
endmacro()

# Adds flags to the link rules of a language, behind those of the target, in probes too.
macro(_tpc_add_link_flags language flags)
  foreach(_tpc_rule LINK_EXECUTABLE CREATE_SHARED_LIBRARY CREATE_SHARED_MODULE)
    string(REPLACE "<LINK_FLAGS>" "<LINK_FLAGS> ${flags}"
      CMAKE_${language}_${_tpc_rule} "${CMAKE_${language}_${_tpc_rule}}")
  endforeach()
  list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CMAKE_${language}_LINK_EXECUTABLE)
endmacro()

# Adds flags to the compile rule of a language, behind those of the target.
macro(_tpc_add_compile_flags language flags)
  string(REPLACE "<FLAGS>" "<FLAGS> ${flags}"
    CMAKE_${language}_COMPILE_OBJECT "${CMAKE_${language}_COMPILE_OBJECT}")
endmacro()

# In a probe: with -Werror among its flags, one that only gcc knows or that clang has
# no use for would make every answer a no.
macro(_tpc_tolerate_flags_in_probes)
  foreach(_tpc_language C CXX)
    if(_tpc_instead_of_${_tpc_language})
      _tpc_name_compiler(${_tpc_language})
    endif()
    if(CMAKE_${_tpc_language}_COMPILER_ID STREQUAL "Clang" OR _tpc_instead_of_${_tpc_language})
      _tpc_add_compile_flags(${_tpc_language} "-Qunused-arguments${_tpc_accept_flags}")
    endif()
  endforeach()
endmacro()

# For assembler sources: to clang the flags for C and C++ that it gets are of no use, of
# which it warns and gcc does not.
macro(_tpc_tolerate_flags_of_assembler)
  # Where it is enabled later it is the compiler for C, or else that for C++.
  set(_tpc_assembler "${CMAKE_ASM_COMPILER}")
  foreach(_tpc_compiler CMAKE_C_COMPILER CMAKE_CXX_COMPILER)
    if(NOT _tpc_assembler)
      set(_tpc_assembler "${${_tpc_compiler}}")
    endif()
  endforeach()
  if(_tpc_assembler STREQUAL "${TPC_CLANG}" OR _tpc_assembler STREQUAL "${TPC_CLANGXX}")
    if(NOT CMAKE_ASM_COMPILE_OBJECT)
      set(CMAKE_ASM_COMPILE_OBJECT
        "<CMAKE_ASM_COMPILER> <DEFINES> <INCLUDES> <FLAGS> -o <OBJECT> -c <SOURCE>")
    endif()
    if(NOT CMAKE_ASM_COMPILE_OBJECT MATCHES "-Qunused-arguments")
      _tpc_add_compile_flags(ASM "-Wno-error -Qunused-arguments")
    endif()
  endif()
endmacro()

# Has clang compile and link, whatever CMAKE_<LANG>_COMPILER becomes after project(), and
# where CMake found gcc before this file was read: in a build folder of before, or in a
# CMakeLists.txt above, as catkin_make's. There the package is told that it is clang, and its
# probes ask clang: flags that only gcc knows end clang's work.
macro(_tpc_replace_compilers)
  set(_tpc_instead_of_C "${TPC_CLANG}")
  set(_tpc_instead_of_CXX "${TPC_CLANGXX}")
  foreach(_tpc_language ${ARGN})
    _tpc_name_compiler(${_tpc_language})
    if(CMAKE_${_tpc_language}_COMPILER_ID STREQUAL "GNU")
      set(CMAKE_${_tpc_language}_COMPILER_ID "Clang")
      set(CMAKE_${_tpc_language}_COMPILER_VERSION "${TPC_CLANG_VERSION}")
      unset(CMAKE_COMPILER_IS_GNU${_tpc_language})
      set(CMAKE_AR "${TPC_AR}")
      set(CMAKE_RANLIB "${TPC_RANLIB}")
      set(CMAKE_${_tpc_language}_COMPILER_AR "${TPC_AR}")
      set(CMAKE_${_tpc_language}_COMPILER_RANLIB "${TPC_RANLIB}")
      # Every probe is a project of this name.
      set(CMAKE_PROJECT_CMAKE_TRY_COMPILE_INCLUDE "${_tpc_file}")
      list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES
        CMAKE_PROJECT_CMAKE_TRY_COMPILE_INCLUDE _tpc_instead_of_${_tpc_language})
    endif()
  endforeach()
  unset(CMAKE_COMPILER_IS_GNUCC)
endmacro()

# Has the rules of a language say clang where they say the language's compiler.
macro(_tpc_name_compiler language)
  # What CMake would add to the compiler's name for another machine is kept.
  if(NOT CMAKE_SYSROOT AND NOT CMAKE_${language}_COMPILER_TARGET
      AND NOT CMAKE_${language}_COMPILER_ARG1)
    foreach(_tpc_rule COMPILE_OBJECT LINK_EXECUTABLE CREATE_SHARED_LIBRARY CREATE_SHARED_MODULE)
      set(_tpc_compiler "\"${_tpc_instead_of_${language}}\"")
      # A compiler's launcher CMake puts before the rule, a linker's before the name.
      if(NOT _tpc_rule STREQUAL "COMPILE_OBJECT" AND CMAKE_${language}_LINKER_LAUNCHER)
        string(REPLACE ";" "\" \"" _tpc_launcher "${CMAKE_${language}_LINKER_LAUNCHER}")
        string(PREPEND _tpc_compiler "\"${_tpc_launcher}\" ")
      endif()
      string(REPLACE "<CMAKE_${language}_COMPILER>" "${_tpc_compiler}"
        CMAKE_${language}_${_tpc_rule} "${CMAKE_${language}_${_tpc_rule}}")
    endforeach()
  endif()
endmacro()

# Takes -ffat-lto-objects, which Linux distributions have among their flags, out of those
# for all targets: native code would stand beside the bitcode, and be what is linked. No
# flag behind it undoes it.
macro(_tpc_want_bitcode_alone)
  foreach(_tpc_language C CXX)
    string(REPLACE "-ffat-lto-objects" "" CMAKE_${_tpc_language}_FLAGS
      "${CMAKE_${_tpc_language}_FLAGS}")
  endforeach()
endmacro()

# Has a package that another compiler builds link the static libraries of the others, which
# hold bitcode: GNU's linkers read it by a plugin of LLVM's. What they make of it reports
# nothing.
macro(_tpc_link_bitcode)
  find_file(TPC_GOLD_PLUGIN LLVMgold.so PATHS "/usr/lib/llvm-${TPC_CLANG_VERSION}/lib"
    NO_DEFAULT_PATH)
  if(TPC_GOLD_PLUGIN)
    foreach(_tpc_language ${ARGN})
      if(CMAKE_${_tpc_language}_COMPILER_ID STREQUAL "GNU")
        _tpc_add_link_flags(${_tpc_language} "\"-Wl,-plugin,${TPC_GOLD_PLUGIN}\"")
      endif()
    endforeach()
  endif()
endmacro()

# Gives a language that the package enables later, by enable_language(), the
# rules of the other one: CMake keeps rules that are there.
macro(_tpc_prepare_language language other)
  foreach(_tpc_rule COMPILE_OBJECT LINK_EXECUTABLE CREATE_SHARED_LIBRARY CREATE_SHARED_MODULE)
    string(REGEX REPLACE "(<[A-Z_]+_)${other}_" "\\1${language}_"
      CMAKE_${language}_${_tpc_rule} "${CMAKE_${other}_${_tpc_rule}}")
  endforeach()
endmacro()

# Adds the flags to the rules of this directory and those below. Nothing of them
# is in a target, so nothing is exported or inherited.
macro(_tpc_instrument)
  if(_tpc_languages STREQUAL "C" AND TPC_CLANGXX AND CMAKE_CXX_COMPILER STREQUAL TPC_CLANGXX)
    _tpc_prepare_language(CXX C)
    set(_tpc_languages C CXX)
  elseif(_tpc_languages STREQUAL "CXX" AND TPC_CLANG AND CMAKE_C_COMPILER STREQUAL TPC_CLANG)
    _tpc_prepare_language(C CXX)
    set(_tpc_languages C CXX)
  endif()
  _tpc_replace_compilers(${_tpc_languages})
  _tpc_want_bitcode_alone()
  _tpc_link_with_lld(${_tpc_languages})
  foreach(_tpc_language IN LISTS _tpc_languages)
    # Behind the flags of the target, whose -fno-lto, -flto=thin or -Werror
    # would break the build or undo ours.
    _tpc_add_compile_flags(${_tpc_language} "${_tpc_compile_flags}")
  endforeach()
  _tpc_tolerate_flags_of_assembler()
  # What was made without the plugin, or by another one, is compiled again, and not taken from a
  # cache: make looks at the flags and definitions of a target, and not at its rules.
  add_compile_definitions("TPC_DEFER=0x${_tpc_defer_hash}")
  string(REPLACE ";" "," _tpc_linked "${_tpc_languages}")
  # In every program and library, because the optimisation that the compiler left
  # out is the plugin's to make up for.
  _tpc_read_flags(linker _tpc_linker_flags)
  _tpc_add_link_options("${_tpc_linker_flags}" "")
  _tpc_add_plugin_option("-tpc-analyse=false" "$<TARGET_PROPERTY:_TPC_OFF>")
  set(_tpc_on "$<NOT:$<BOOL:$<TARGET_PROPERTY:_TPC_OFF>>>")
  _tpc_add_plugin_option("-tpc-link-unit=$<TARGET_PROPERTY:NAME>" "${_tpc_on}")
  _tpc_add_plugin_option("-tpc-package=$<TARGET_PROPERTY:_TPC_PACKAGE>" "${_tpc_on}")
  _tpc_add_plugin_option("-tpc-source-root=$<TARGET_PROPERTY:_TPC_SOURCE_ROOT>" "${_tpc_on}")
  _tpc_add_plugin_option("-tpc-exclude=$<TARGET_PROPERTY:_TPC_EXCLUDED>"
    "$<BOOL:$<TARGET_PROPERTY:_TPC_EXCLUDED>>")
  _tpc_add_plugin_option("-tpc-static-info=$<TARGET_PROPERTY:_TPC_STATIC_INFO>" "${_tpc_on}")
  foreach(_tpc_setting PROFILE MAX_SECONDS MAX_MEMORY)
    if(NOT "${TPC_${_tpc_setting}}" STREQUAL "")
      string(TOLOWER "${_tpc_setting}" _tpc_option)
      string(REPLACE "_" "-" _tpc_option "${_tpc_option}")
      _tpc_add_plugin_option("-tpc-${_tpc_option}=${TPC_${_tpc_setting}}" "${_tpc_on}")
    endif()
  endforeach()
  if(TPC_RULES)
    get_filename_component(_tpc_rules "${TPC_RULES}" ABSOLUTE BASE_DIR "${CMAKE_SOURCE_DIR}")
    _tpc_add_plugin_option("-tpc-rules=${_tpc_rules}" "${_tpc_on}")
  endif()
  if(TPC_CONSTANTS)
    _tpc_add_plugin_option("-tpc-constants" "${_tpc_on}")
  endif()
  _tpc_read_flags(last _tpc_last_flags)
  _tpc_add_link_options("${_tpc_last_flags}" "${_tpc_on}")
endmacro()

# Has the linker given options, where `condition` (a generator expression; always where
# it is empty) is 1. A comma in them is no separator, and a space in quotes neither.
function(_tpc_add_link_options options condition)
  set(linked "$<LINK_LANGUAGE:${_tpc_linked}>")
  if(condition)
    set(linked "$<AND:${linked},$<BOOL:${condition}>>")
  endif()
  string(STRIP "${options}" options)
  add_link_options("$<${linked}:LINKER:SHELL:${options}>")
endfunction()

# The same for an option of LLVM's or of its plugins.
function(_tpc_add_plugin_option option condition)
  _tpc_add_link_options("-mllvm \"${option}\"" "${condition}")
endfunction()

# After project(): sees to the languages that it has enabled.
macro(_tpc_enter_project)
  set(_tpc_languages C CXX)
  foreach(_tpc_language C CXX)
    if(NOT CMAKE_${_tpc_language}_COMPILER_ID)
      list(REMOVE_ITEM _tpc_languages ${_tpc_language})
    endif()
  endforeach()
  # In a patched package below another project() its own one is yet to come.
  set(_tpc_name "${PROJECT_NAME}")
  if(NOT PROJECT_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
    get_filename_component(_tpc_name "${CMAKE_CURRENT_SOURCE_DIR}" NAME)
  endif()
  _tpc_find_compilers()
  _tpc_find_obstacle()
  set(_tpc_entered TRUE)
  if(NOT _tpc_obstacle)
    if(_tpc_languages)
      set(_tpc_done TRUE)
      _tpc_instrument()
    endif()
  else()
    set(_tpc_done TRUE)
    if(NOT TPC_DISABLE)
      message(WARNING "TPC: ${_tpc_name} is built without instrumentation: ${_tpc_obstacle}")
    endif()
    # It may use the libraries of instrumented packages all the same, if the
    # compilers are those that we chose; and what they warn of ends no build.
    foreach(_tpc_language IN LISTS _tpc_languages)
      if(CMAKE_${_tpc_language}_COMPILER STREQUAL "${TPC_CLANG}"
          OR CMAKE_${_tpc_language}_COMPILER STREQUAL "${TPC_CLANGXX}")
        _tpc_add_compile_flags(${_tpc_language} "-Wno-error${_tpc_accept_flags}")
        _tpc_tolerate_flags_of_assembler()
        if(TPC_LLD)
          _tpc_link_with_lld(${_tpc_language})
        endif()
      else()
        _tpc_link_bitcode(${_tpc_language})
      endif()
    endforeach()
  endif()
  get_property(_tpc_deferred GLOBAL PROPERTY _tpc_deferred)
  if(NOT _tpc_deferred)
    set_property(GLOBAL PROPERTY _tpc_deferred TRUE)
    set_property(DIRECTORY "${CMAKE_SOURCE_DIR}" APPEND PROPERTY
      CMAKE_CONFIGURE_DEPENDS "${_tpc_defer}")
    cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL _tpc_finish)
  endif()
endmacro()

# One file only can be included after project(): ours, which then includes the one that was
# asked for.
macro(_tpc_be_next_include)
  if(NOT CMAKE_PROJECT_INCLUDE STREQUAL _tpc_file)
    set(_tpc_next_include "${CMAKE_PROJECT_INCLUDE}")
    set(CMAKE_PROJECT_INCLUDE "${_tpc_file}")
  endif()
endmacro()

get_property(_tpc_probe GLOBAL PROPERTY IN_TRY_COMPILE)
get_property(_tpc_enabled GLOBAL PROPERTY ENABLED_LANGUAGES)
if("${CMAKE_SOURCE_DIR}" IN_LIST TPC_LEFT_ALONE)
  set(_tpc_left_alone TRUE)
  # The probes of the package, too, which are projects of their own.
  list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES _tpc_left_alone)
endif()
if(_tpc_left_alone)
  # Not even another compiler.
  if(NOT _tpc_probe)
    if(NOT _tpc_enabled)
      _tpc_be_next_include()
    elseif(NOT _tpc_done)
      set(_tpc_done TRUE)
      _tpc_link_bitcode(C CXX)
      if(_tpc_next_include)
        include("${_tpc_next_include}")
      endif()
    endif()
  endif()
elseif(_tpc_probe)
  # Probes of the compiler are nobody's program; they only need the compiler.
  if(NOT _tpc_enabled)
    _tpc_choose_compilers()
  else()
    _tpc_tolerate_flags_in_probes()
  endif()
elseif(NOT _tpc_enabled)
  _tpc_choose_compilers()
  _tpc_be_next_include()
  list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CMAKE_PROJECT_INCLUDE)
elseif(NOT _tpc_done)
  # Otherwise a project() inside the package, which has inherited the rules.
  _tpc_enter_project()
  if(_tpc_next_include)
    include("${_tpc_next_include}")
  endif()
endif()

cmake_policy(POP)
