# Builds a package with the passes of TPC. There are three ways to use this file:
#
#   -DCMAKE_TOOLCHAIN_FILE=.../tpc.cmake   what `pytpc build` does
#   -DCMAKE_PROJECT_INCLUDE=.../tpc.cmake  with the compilers chosen elsewhere
#   include(.../tpc.cmake)                 at the top of a CMakeLists.txt, as
#                                          `pytpc patch` puts it there
#
# Before project() it chooses the compilers. After project() it adds flags to the rules by which
# CMake compiles and links. If it cannot do that, it prints one warning and does not change the
# build.
#
#   TPC_CLANG_VERSION  release of clang, lld and LLVM (the one that the plugins are for)
#   TPC_RULES          the user's own file of rules
#   TPC_PROFILE        thesis or default
#   TPC_MAX_SECONDS    processor time that the analysis of a link unit may take (120)
#   TPC_MAX_MEMORY     MiB that it may take (4096)
#   TPC_CONSTANTS      also report comparisons with constants in the source
#   TPC_TESTS          also analyse test programs, and insert reports into them
#   TPC_DISABLE        do not change this package
#   TPC_LEFT_ALONE     folders of packages that are not changed at all, not even their compiler
#   TPC_BASE           folder of `pytpc build`; see tpc-devel.cmake
#
# The property TPC_INSTRUMENT of a target keeps reports out of it if it is OFF, and inserts them
# into a test program if it is ON. tpc-targets.cmake sets up the targets.

cmake_policy(PUSH)
cmake_policy(VERSION 3.16)
include("${CMAKE_CURRENT_LIST_DIR}/tpc-compilers.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/tpc-targets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/tpc-devel.cmake")

set(_tpc_file "${CMAKE_CURRENT_LIST_FILE}")
get_filename_component(_tpc_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(_tpc_plugin "${_tpc_prefix}/lib/tpc/TpcPasses.so")
set(_tpc_defer "${_tpc_prefix}/lib/tpc/TpcDefer.so")
set(_tpc_log "${_tpc_prefix}/lib/libtpc_log.so")
set(_tpc_relink "${_tpc_prefix}/bin/tpc-relink")
set(_tpc_flags_file "${_tpc_prefix}/share/tpc/flags")
# CMake's rules that link, without CMAKE_<LANG>_.
set(_tpc_link_rules LINK_EXECUTABLE CREATE_SHARED_LIBRARY CREATE_SHARED_MODULE)
set(_tpc_release 19)
if(EXISTS "${_tpc_prefix}/share/tpc/clang-version")
  file(STRINGS "${_tpc_prefix}/share/tpc/clang-version" _tpc_release LIMIT_COUNT 1)
endif()
if(NOT TPC_CLANG_VERSION)
  set(TPC_CLANG_VERSION ${_tpc_release})
endif()
# Sets `text` to the flags of one kind in share/tpc/flags, quoted for a shell. That file says what
# they are for.
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

# Makes lld link everything in these languages, including CMake's checks: a static library of
# another package may hold bitcode. The flags are put into the rules because CMAKE_EXE_LINKER_FLAGS
# applies to all languages, and gfortran and nvcc reject these flags; and because packages overwrite
# that variable.
macro(_tpc_link_with_lld)
  _tpc_read_flags(link _tpc_link_flags)
  foreach(_tpc_language ${ARGN})
    _tpc_add_link_flags(${_tpc_language} "${_tpc_link_flags}")
  endforeach()
endmacro()

# Adds flags to the link rules of a language, after those of the target; also in CMake's checks.
macro(_tpc_add_link_flags language flags)
  foreach(_tpc_rule IN LISTS _tpc_link_rules)
    string(REPLACE "<LINK_FLAGS>" "<LINK_FLAGS> ${flags}"
      CMAKE_${language}_${_tpc_rule} "${CMAKE_${language}_${_tpc_rule}}")
  endforeach()
  list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CMAKE_${language}_LINK_EXECUTABLE)
endmacro()

# Adds flags to the compile rule of a language, after those of the target.
macro(_tpc_add_compile_flags language flags)
  string(REPLACE "<FLAGS>" "<FLAGS> ${flags}"
    CMAKE_${language}_COMPILE_OBJECT "${CMAKE_${language}_COMPILE_OBJECT}")
endmacro()

# For CMake's checks: with -Werror, a flag that only gcc knows or that clang does not need would
# make every check fail.
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

# For assembler sources: clang warns about flags for C and C++ that have no effect there; gcc does
# not.
macro(_tpc_tolerate_flags_of_assembler)
  # If assembler is enabled later, it uses the compiler for C or, without one, that for C++.
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

# Makes clang compile and link, whatever CMAKE_<LANG>_COMPILER becomes after project(), and also if
# CMake found gcc before it read this file: in an older build folder, or in a CMakeLists.txt above,
# like that of catkin_make. The package is then told that the compiler is clang, and its checks run
# clang, because clang rejects flags that only gcc knows.
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
      # Every check is a project of this name.
      set(CMAKE_PROJECT_CMAKE_TRY_COMPILE_INCLUDE "${_tpc_file}")
      list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES
        CMAKE_PROJECT_CMAKE_TRY_COMPILE_INCLUDE _tpc_instead_of_${_tpc_language})
    endif()
  endforeach()
  unset(CMAKE_COMPILER_IS_GNUCC)
endmacro()

# Leaves out links that would change nothing.
macro(_tpc_link_when_needed)
  if(EXISTS "${_tpc_relink}")
    foreach(_tpc_language ${ARGN})
      foreach(_tpc_rule IN LISTS _tpc_link_rules)
        string(PREPEND CMAKE_${_tpc_language}_${_tpc_rule} "\"${_tpc_relink}\" ")
      endforeach()
    endforeach()
  endif()
endmacro()

# Puts clang in place of the language's compiler in the rules of a language.
macro(_tpc_name_compiler language)
  # Keeps what CMake adds to the name of the compiler for another machine.
  if(NOT CMAKE_SYSROOT AND NOT CMAKE_${language}_COMPILER_TARGET
      AND NOT CMAKE_${language}_COMPILER_ARG1)
    foreach(_tpc_rule COMPILE_OBJECT ${_tpc_link_rules})
      set(_tpc_compiler "\"${_tpc_instead_of_${language}}\"")
      # CMake puts the launcher of a compiler before the rule, and that of a linker before the name.
      if(NOT _tpc_rule STREQUAL "COMPILE_OBJECT" AND CMAKE_${language}_LINKER_LAUNCHER)
        string(REPLACE ";" "\" \"" _tpc_launcher "${CMAKE_${language}_LINKER_LAUNCHER}")
        string(PREPEND _tpc_compiler "\"${_tpc_launcher}\" ")
      endif()
      string(REPLACE "<CMAKE_${language}_COMPILER>" "${_tpc_compiler}"
        CMAKE_${language}_${_tpc_rule} "${CMAKE_${language}_${_tpc_rule}}")
    endforeach()
  endif()
endmacro()

# Removes -ffat-lto-objects, which Linux distributions put among their flags, from those for all
# targets: otherwise the native code beside the bitcode would be linked. No later flag undoes it.
macro(_tpc_want_bitcode_alone)
  foreach(_tpc_language C CXX)
    string(REPLACE "-ffat-lto-objects" "" CMAKE_${_tpc_language}_FLAGS
      "${CMAKE_${_tpc_language}_FLAGS}")
  endforeach()
endmacro()

# Lets a package built by another compiler link the static libraries of other packages, which hold
# bitcode: GNU's linkers read it with a plugin of LLVM. The result contains no reports.
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

# Gives a language that the package enables later, by enable_language(), the rules of the other one:
# CMake keeps existing rules.
macro(_tpc_prepare_language language other)
  foreach(_tpc_rule COMPILE_OBJECT ${_tpc_link_rules})
    string(REGEX REPLACE "(<[A-Z_]+_)${other}_" "\\1${language}_"
      CMAKE_${language}_${_tpc_rule} "${CMAKE_${other}_${_tpc_rule}}")
  endforeach()
endmacro()

# Adds the flags to the rules of this directory and those below. Targets are not changed, so nothing
# is exported or inherited.
macro(_tpc_instrument)
  if(_tpc_languages STREQUAL "C" AND TPC_CLANGXX AND CMAKE_CXX_COMPILER STREQUAL TPC_CLANGXX)
    _tpc_prepare_language(CXX C)
    set(_tpc_languages C CXX)
  elseif(_tpc_languages STREQUAL "CXX" AND TPC_CLANG AND CMAKE_C_COMPILER STREQUAL TPC_CLANG)
    _tpc_prepare_language(C CXX)
    set(_tpc_languages C CXX)
  endif()
  _tpc_replace_compilers(${_tpc_languages})
  _tpc_link_when_needed(${_tpc_languages})
  _tpc_want_bitcode_alone()
  _tpc_link_with_lld(${_tpc_languages})
  foreach(_tpc_language IN LISTS _tpc_languages)
    # After the flags of the target, whose -fno-lto, -flto=thin or -Werror would break the build or
    # undo those of TPC.
    _tpc_add_compile_flags(${_tpc_language} "${_tpc_compile_flags}")
  endforeach()
  _tpc_tolerate_flags_of_assembler()
  # Objects made without the plugin, or with another version of it, are compiled again and not taken
  # from a cache: make compares the flags and definitions of a target, but not its rules.
  add_compile_definitions("TPC_DEFER=0x${_tpc_defer_hash}")
  string(REPLACE ";" "," _tpc_linked "${_tpc_languages}")
  # In every program and library, because the plugin must run the optimisation that the compiler
  # left out.
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
  _tpc_add_plugin_option("-tpc-manifest=$<TARGET_PROPERTY:_TPC_MANIFEST>" "${_tpc_on}")
  _tpc_add_plugin_option("-tpc-plans=$<TARGET_PROPERTY:_TPC_PLANS>" "${_tpc_on}")
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
  # CMake puts the options before the libraries.
  if("$ENV{ROS_VERSION}" STREQUAL "2")
    _tpc_read_flags(program _tpc_program_flags)
    _tpc_add_link_options("${_tpc_program_flags}"
      "$<AND:${_tpc_on},$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>>")
  endif()
  foreach(_tpc_kind IN ITEMS log last)
    _tpc_read_flags(${_tpc_kind} _tpc_last_flags)
    _tpc_add_link_options("${_tpc_last_flags}" "${_tpc_on}")
  endforeach()
endmacro()

# Passes options to the linker if `condition` (a generator expression; empty: always) is 1. Commas
# do not separate them, and neither do spaces inside quotes.
function(_tpc_add_link_options options condition)
  set(linked "$<LINK_LANGUAGE:${_tpc_linked}>")
  if(condition)
    set(linked "$<AND:${linked},$<BOOL:${condition}>>")
  endif()
  string(STRIP "${options}" options)
  add_link_options("$<${linked}:LINKER:SHELL:${options}>")
endfunction()

# The same for an option of LLVM or of its plugins.
function(_tpc_add_plugin_option option condition)
  _tpc_add_link_options("-mllvm \"${option}\"" "${condition}")
endfunction()

# After project(): handles the languages that it has enabled.
macro(_tpc_enter_project)
  set(_tpc_languages C CXX)
  foreach(_tpc_language C CXX)
    if(NOT CMAKE_${_tpc_language}_COMPILER_ID)
      list(REMOVE_ITEM _tpc_languages ${_tpc_language})
    endif()
  endforeach()
  # In a patched package below another project(), the package's own project() comes later.
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
    # It may still use the libraries of instrumented packages if TPC chose its compilers; their
    # warnings must not end the build.
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

# Only one file can be included after project(). TPC includes its own, which then includes the file
# that the user asked for.
macro(_tpc_be_next_include)
  if(NOT CMAKE_PROJECT_INCLUDE STREQUAL _tpc_file)
    set(_tpc_next_include "${CMAKE_PROJECT_INCLUDE}")
    set(CMAKE_PROJECT_INCLUDE "${_tpc_file}")
  endif()
endmacro()

get_property(_tpc_probe GLOBAL PROPERTY IN_TRY_COMPILE)
get_property(_tpc_enabled GLOBAL PROPERTY ENABLED_LANGUAGES)
if(TPC_BASE AND NOT _tpc_probe AND NOT _tpc_enabled)
  _tpc_find_devel_spaces()
endif()
if("${CMAKE_SOURCE_DIR}" IN_LIST TPC_LEFT_ALONE)
  set(_tpc_left_alone TRUE)
  # Also the package's checks, which are projects of their own.
  list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES _tpc_left_alone)
endif()
if(_tpc_left_alone)
  # Not even with another compiler.
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
  # CMake's checks of the compiler belong to no program; they only need the compiler.
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
  # Otherwise this is a project() inside the package, which has inherited the rules.
  _tpc_enter_project()
  if(_tpc_next_include)
    include("${_tpc_next_include}")
  endif()
endif()

cmake_policy(POP)
