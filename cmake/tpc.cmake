# Builds a package with the passes of TPC. One file with three entrances:
#
#   -DCMAKE_TOOLCHAIN_FILE=.../tpc.cmake   what `pytpc build` does
#   -DCMAKE_PROJECT_INCLUDE=.../tpc.cmake  with the compilers chosen elsewhere
#   include(.../tpc.cmake)                 at the top of a CMakeLists.txt, as
#                                          `python -m pytpc.patch` puts it there
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
#   TPC_DISABLE        leave this package alone

cmake_policy(PUSH)
cmake_policy(VERSION 3.16)

get_filename_component(_tpc_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(_tpc_plugin "${_tpc_prefix}/lib/tpc/TpcPasses.so")
set(_tpc_defer "${_tpc_prefix}/lib/tpc/TpcDefer.so")
set(_tpc_log "${_tpc_prefix}/lib/libtpc_log.so")
set(_tpc_flags_file "${_tpc_prefix}/share/tpc/flags")
if(NOT TPC_CLANG_VERSION)
  set(TPC_CLANG_VERSION 19)
endif()
set(_tpc_constants "")
if(TPC_CONSTANTS)
  set(_tpc_constants "-tpc-constants")
endif()
# Adds the flags of one kind in share/tpc/flags to `text`, as a shell reads them; the words
# of a linker's flag are joined as it wants them. What they are for is said there.
function(_tpc_read_flags kind text)
  set(read "${${text}}")
  if(EXISTS "${_tpc_flags_file}")
    file(STRINGS "${_tpc_flags_file}" flags REGEX "^${kind} ")
    foreach(flag IN LISTS flags)
      string(REGEX REPLACE "^${kind} " "" flag "${flag}")
      if(kind MATCHES "^(linker|last)$")
        string(REPLACE " " "," flag "-Wl,${flag}")
      endif()
      string(REPLACE "@PREFIX@" "${_tpc_prefix}" placed "${flag}")
      string(REPLACE "@LLD@" "${TPC_LLD}" placed "${placed}")
      if(NOT placed STREQUAL flag)
        set(placed "\"${placed}\"")
      endif()
      string(APPEND read " ${placed}")
    endforeach()
  endif()
  set(${text} "${read}" PARENT_SCOPE)
endfunction()

# What another plugin made is compiled again, and not taken from a cache.
set(_tpc_defer_hash "")
if(EXISTS "${_tpc_defer}")
  file(SHA256 "${_tpc_defer}" _tpc_defer_hash)
  string(SUBSTRING "${_tpc_defer_hash}" 0 8 _tpc_defer_hash)
endif()
set(_tpc_compile_flags " -DTPC_DEFER=0x${_tpc_defer_hash}")
_tpc_read_flags(compile _tpc_compile_flags)

# Sets `found` to the first flag in `text` that has the compiler instrument the
# code by itself: it would do so in the passes that TPC makes it leave out, so
# the flag would be lost without a word.
function(_tpc_find_sanitizer text found)
  set(pattern "-fsanitize=[^ ]+|--coverage|-ftest-coverage|-fcoverage-mapping|-fprofile-[^ ]+")
  if(text MATCHES "(^| )(${pattern})")
    set(${found} "${CMAKE_MATCH_2}" PARENT_SCOPE)
  else()
    set(${found} "" PARENT_SCOPE)
  endif()
endfunction()

# Sets _tpc_sanitizer to such a flag among those for all targets of the package,
# _tpc_sanitizer_place to where it is and _tpc_sanitizer_flags to all that is there.
macro(_tpc_find_sanitizer_of_package)
  set(_tpc_sanitizer "")
  set(_tpc_places CMAKE_C_FLAGS CMAKE_CXX_FLAGS)
  foreach(_tpc_configuration IN LISTS CMAKE_BUILD_TYPE CMAKE_CONFIGURATION_TYPES)
    string(TOUPPER "${_tpc_configuration}" _tpc_configuration)
    list(APPEND _tpc_places
      CMAKE_C_FLAGS_${_tpc_configuration} CMAKE_CXX_FLAGS_${_tpc_configuration})
  endforeach()
  foreach(_tpc_place IN LISTS _tpc_places)
    set(_tpc_flags "${${_tpc_place}}")
    # Before project() the environment is not yet in the variables.
    if(_tpc_place STREQUAL "CMAKE_C_FLAGS" AND NOT DEFINED CMAKE_C_FLAGS)
      set(_tpc_flags "$ENV{CFLAGS}")
    elseif(_tpc_place STREQUAL "CMAKE_CXX_FLAGS" AND NOT DEFINED CMAKE_CXX_FLAGS)
      set(_tpc_flags "$ENV{CXXFLAGS}")
    endif()
    _tpc_find_sanitizer("${_tpc_flags}" _tpc_flag)
    if(_tpc_flag AND NOT _tpc_sanitizer)
      set(_tpc_sanitizer "${_tpc_flag}")
      set(_tpc_sanitizer_place "${_tpc_place}")
      set(_tpc_sanitizer_flags "${_tpc_flags}")
    endif()
  endforeach()
endmacro()

# Sets `links` to whether clang links a program with these flags: for a sanitizer
# it needs libclang-rt-dev, which gcc does not.
function(_tpc_try_clang flags links)
  set(folder "${CMAKE_BINARY_DIR}/CMakeFiles/tpc")
  file(WRITE "${folder}/main.c" "int main(void) { return 0; }\n")
  separate_arguments(flags UNIX_COMMAND "${flags}")
  execute_process(COMMAND "${TPC_CLANG}" -w ${flags} main.c -o main WORKING_DIRECTORY "${folder}"
    RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(status EQUAL 0)
    set(${links} TRUE PARENT_SCOPE)
  else()
    set(${links} FALSE PARENT_SCOPE)
  endif()
endfunction()

# Chooses clang and LLVM's archiver, where nobody has chosen another compiler. A
# package with a sanitizer that clang cannot link keeps the compiler it had.
macro(_tpc_choose_compilers)
  find_program(TPC_CLANG clang-${TPC_CLANG_VERSION})
  find_program(TPC_CLANGXX clang++-${TPC_CLANG_VERSION})
  find_program(TPC_AR llvm-ar-${TPC_CLANG_VERSION})
  find_program(TPC_RANLIB llvm-ranlib-${TPC_CLANG_VERSION})
  set(_tpc_clang_links TRUE)
  _tpc_find_sanitizer_of_package()
  if(TPC_CLANG AND _tpc_sanitizer AND NOT _tpc_probe)
    _tpc_try_clang("${_tpc_sanitizer_flags}" _tpc_clang_links)
  endif()
  if(NOT _tpc_clang_links)
    # _tpc_find_obstacle says why.
  elseif(TPC_CLANG AND TPC_CLANGXX AND TPC_AR AND TPC_RANLIB)
    if(NOT CMAKE_C_COMPILER)
      set(CMAKE_C_COMPILER "${TPC_CLANG}")
    endif()
    if(NOT CMAKE_CXX_COMPILER)
      set(CMAKE_CXX_COMPILER "${TPC_CLANGXX}")
    endif()
    # Archives hold bitcode, which the system's archiver cannot index.
    set(CMAKE_AR "${TPC_AR}" CACHE FILEPATH "archiver")
    set(CMAKE_RANLIB "${TPC_RANLIB}" CACHE FILEPATH "ranlib")
    foreach(_tpc_language C CXX)
      set(CMAKE_${_tpc_language}_COMPILER_AR "${TPC_AR}")
      set(CMAKE_${_tpc_language}_COMPILER_RANLIB "${TPC_RANLIB}")
    endforeach()
  else()
    message(WARNING "TPC: clang ${TPC_CLANG_VERSION} is not here; this package is built without it "
      "(apt-get install clang-${TPC_CLANG_VERSION} lld-${TPC_CLANG_VERSION} llvm-${TPC_CLANG_VERSION})")
  endif()
endmacro()

# Sets _tpc_obstacle to why the package cannot be instrumented; empty where it can.
macro(_tpc_find_obstacle)
  set(_tpc_obstacle "")
  if(NOT TPC_LLD)
    set(_tpc_obstacle "ld.lld-${TPC_CLANG_VERSION} is not here (apt-get install lld-${TPC_CLANG_VERSION})")
  endif()
  foreach(_tpc_part IN ITEMS "${_tpc_flags_file}" "${_tpc_defer}" "${_tpc_plugin}" "${_tpc_log}")
    if(NOT EXISTS "${_tpc_part}")
      set(_tpc_obstacle "${_tpc_part} is not there")
    endif()
  endforeach()
  foreach(_tpc_language IN LISTS _tpc_languages)
    if(NOT CMAKE_${_tpc_language}_COMPILER_ID STREQUAL "Clang")
      set(_tpc_obstacle "the compiler is ${CMAKE_${_tpc_language}_COMPILER_ID}, not clang (a build folder keeps its compiler: remove ${CMAKE_BINARY_DIR})")
    elseif(NOT CMAKE_${_tpc_language}_COMPILER_VERSION MATCHES "^${TPC_CLANG_VERSION}\\.")
      set(_tpc_obstacle "the compiler is clang ${CMAKE_${_tpc_language}_COMPILER_VERSION}, the passes are for ${TPC_CLANG_VERSION}")
    endif()
  endforeach()
  _tpc_find_sanitizer_of_package()
  if(_tpc_sanitizer)
    set(_tpc_obstacle "${_tpc_sanitizer} in ${_tpc_sanitizer_place} does not go together with it")
  endif()
endmacro()

# Has what is linked from these languages linked by lld, the probes included:
# a static library of a package below holds bitcode. It stands in the rules
# because CMAKE_EXE_LINKER_FLAGS is for all languages, and gfortran and nvcc do
# not know these flags; and because packages overwrite that variable.
macro(_tpc_link_with_lld)
  set(_tpc_link_flags "")
  _tpc_read_flags(link _tpc_link_flags)
  foreach(_tpc_language ${ARGN})
    foreach(_tpc_rule LINK_EXECUTABLE CREATE_SHARED_LIBRARY CREATE_SHARED_MODULE)
      string(REPLACE "<LINK_FLAGS>" "<LINK_FLAGS>${_tpc_link_flags}"
        CMAKE_${_tpc_language}_${_tpc_rule} "${CMAKE_${_tpc_language}_${_tpc_rule}}")
    endforeach()
    list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CMAKE_${_tpc_language}_LINK_EXECUTABLE)
  endforeach()
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
  _tpc_link_with_lld(${_tpc_languages})
  set(_tpc_last_flags "")
  _tpc_read_flags(last _tpc_last_flags)
  foreach(_tpc_language IN LISTS _tpc_languages)
    # Behind the flags of the target, whose -fno-lto, -flto=thin or -Werror
    # would break the build or undo ours.
    string(REPLACE "<FLAGS>" "<FLAGS>${_tpc_compile_flags}"
      CMAKE_${_tpc_language}_COMPILE_OBJECT "${CMAKE_${_tpc_language}_COMPILE_OBJECT}")
    # At the end of every link line.
    string(APPEND CMAKE_${_tpc_language}_STANDARD_LIBRARIES "${_tpc_last_flags}")
  endforeach()
  set(_tpc_options
    "-tpc-link-unit=$<TARGET_PROPERTY:NAME>"
    "-tpc-package=${PROJECT_NAME}"
    "-tpc-source-root=${CMAKE_SOURCE_DIR}"
    "-tpc-exclude=${CMAKE_BINARY_DIR}"
    "-tpc-static-info=${CMAKE_BINARY_DIR}/tpc/$<TARGET_PROPERTY:NAME>.json")
  if(TPC_PROFILE)
    list(APPEND _tpc_options "-tpc-profile=${TPC_PROFILE}")
  endif()
  if(DEFINED TPC_MAX_SECONDS)
    list(APPEND _tpc_options "-tpc-max-seconds=${TPC_MAX_SECONDS}")
  endif()
  if(DEFINED TPC_MAX_MEMORY)
    list(APPEND _tpc_options "-tpc-max-memory=${TPC_MAX_MEMORY}")
  endif()
  if(TPC_RULES)
    get_filename_component(_tpc_rules "${TPC_RULES}" ABSOLUTE BASE_DIR "${CMAKE_SOURCE_DIR}")
    list(APPEND _tpc_options "-tpc-rules=${_tpc_rules}")
  endif()
  list(APPEND _tpc_options ${_tpc_constants})
  string(REPLACE ";" "," _tpc_linked "${_tpc_languages}")
  set(_tpc_linker_flags "")
  _tpc_read_flags(linker _tpc_linker_flags)
  add_link_options("$<$<LINK_LANGUAGE:${_tpc_linked}>:SHELL:${_tpc_linker_flags}>")
  foreach(_tpc_option IN LISTS _tpc_options)
    add_link_options("$<$<LINK_LANGUAGE:${_tpc_linked}>:LINKER:-mllvm,${_tpc_option}>")
  endforeach()
endmacro()

# At the end of the package's CMakeLists.txt: what is linked is linked again when
# the passes, the log library or the rules have changed; and what TPC does not see
# to after all is said. Flags in generator expressions and in the interface of another
# target are not known here.
function(_tpc_finish)
  _tpc_finish_folder("${CMAKE_SOURCE_DIR}")
  get_property(lost GLOBAL PROPERTY _tpc_lost)
  if(lost)
    string(REPLACE ";" ", " lost "${lost}")
    message(WARNING "TPC: lost in what is built with TPC: ${lost}; keep it with -DTPC_DISABLE=ON")
  endif()
  get_property(plain GLOBAL PROPERTY _tpc_plain)
  if(plain)
    string(REPLACE ";" ", " plain "${plain}")
    message(WARNING "TPC: built without instrumentation, because the language was enabled after "
      "project() or its compile rule was replaced: ${plain}; name the language in project()")
  endif()
endfunction()

function(_tpc_finish_folder folder)
  get_directory_property(below DIRECTORY "${folder}" SUBDIRECTORIES)
  foreach(subfolder IN LISTS below)
    _tpc_finish_folder("${subfolder}")
  endforeach()
  get_directory_property(entered DIRECTORY "${folder}" DEFINITION _tpc_entered)
  if(NOT entered)
    return()
  endif()
  get_property(enabled GLOBAL PROPERTY ENABLED_LANGUAGES)
  set(patterns "")
  set(common_flags "")
  set(suffixes_C "c")
  set(suffixes_CXX "C|cc|cpp|cxx|c\\+\\+|CPP")
  foreach(language C CXX)
    get_directory_property(rule DIRECTORY "${folder}" DEFINITION CMAKE_${language}_COMPILE_OBJECT)
    get_directory_property(common DIRECTORY "${folder}" DEFINITION CMAKE_${language}_FLAGS)
    list(APPEND common_flags "${common}")
    if(language IN_LIST enabled AND NOT rule MATCHES "-fpass-plugin=")
      list(APPEND patterns "\\.(${suffixes_${language}})$")
    endif()
  endforeach()
  get_directory_property(plugin DIRECTORY "${folder}" DEFINITION _tpc_plugin)
  get_directory_property(log DIRECTORY "${folder}" DEFINITION _tpc_log)
  get_directory_property(rules DIRECTORY "${folder}" DEFINITION _tpc_rules)
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type "${target}" TYPE)
    if(type MATCHES "^(EXECUTABLE|SHARED_LIBRARY|MODULE_LIBRARY)$")
      set_property(TARGET "${target}" APPEND PROPERTY LINK_DEPENDS "${plugin}" "${log}")
      if(rules AND EXISTS "${rules}")
        set_property(TARGET "${target}" APPEND PROPERTY LINK_DEPENDS "${rules}")
      endif()
    elseif(NOT type MATCHES "^(STATIC|OBJECT)_LIBRARY$")
      continue()
    endif()
    get_property(flags TARGET "${target}" PROPERTY COMPILE_FLAGS)
    get_property(options TARGET "${target}" PROPERTY COMPILE_OPTIONS)
    string(REGEX REPLACE ";(SHELL:)?" " " flags "${common_flags};${flags};${options}")
    _tpc_find_sanitizer("${flags}" flag)
    if(flag)
      set_property(GLOBAL APPEND PROPERTY _tpc_lost "${flag} of ${target}")
    endif()
    get_property(sources TARGET "${target}" PROPERTY SOURCES)
    foreach(pattern IN LISTS patterns)
      set(matching "${sources}")
      list(FILTER matching INCLUDE REGEX "${pattern}")
      if(matching)
        set_property(GLOBAL APPEND PROPERTY _tpc_plain "${target}")
        break()
      endif()
    endforeach()
  endforeach()
endfunction()

# After project(): sees to the languages that it has enabled.
macro(_tpc_enter_project)
  set(_tpc_languages C CXX)
  foreach(_tpc_language C CXX)
    if(NOT CMAKE_${_tpc_language}_COMPILER_ID)
      list(REMOVE_ITEM _tpc_languages ${_tpc_language})
    endif()
  endforeach()
  find_program(TPC_LLD ld.lld-${TPC_CLANG_VERSION})
  _tpc_find_obstacle()
  if(NOT TPC_DISABLE AND NOT _tpc_obstacle)
    set(_tpc_entered TRUE)
    if(_tpc_languages)
      set(_tpc_done TRUE)
      _tpc_instrument()
    endif()
    get_property(_tpc_deferred GLOBAL PROPERTY _tpc_deferred)
    if(NOT _tpc_deferred)
      set_property(GLOBAL PROPERTY _tpc_deferred TRUE)
      set_property(DIRECTORY "${CMAKE_SOURCE_DIR}" APPEND PROPERTY
        CMAKE_CONFIGURE_DEPENDS "${_tpc_defer}")
      cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL _tpc_finish)
    endif()
  else()
    set(_tpc_done TRUE)
    if(NOT TPC_DISABLE)
      message(WARNING "TPC: ${PROJECT_NAME} is built without instrumentation: ${_tpc_obstacle}")
    endif()
    # It may use the libraries of instrumented packages all the same, if the
    # compilers are those that we chose.
    if(TPC_LLD AND CMAKE_C_COMPILER_ID AND CMAKE_C_COMPILER STREQUAL "${TPC_CLANG}")
      _tpc_link_with_lld(C)
    endif()
    if(TPC_LLD AND CMAKE_CXX_COMPILER_ID AND CMAKE_CXX_COMPILER STREQUAL "${TPC_CLANGXX}")
      _tpc_link_with_lld(CXX)
    endif()
  endif()
endmacro()

get_property(_tpc_probe GLOBAL PROPERTY IN_TRY_COMPILE)
get_property(_tpc_enabled GLOBAL PROPERTY ENABLED_LANGUAGES)
if(_tpc_probe)
  # Probes of the compiler are nobody's program; they only need the compiler.
  if(NOT _tpc_enabled)
    _tpc_choose_compilers()
  endif()
elseif(NOT _tpc_enabled)
  _tpc_choose_compilers()
  # One file only can be included after project(): ours, which then includes
  # the one that was asked for.
  if(NOT CMAKE_PROJECT_INCLUDE STREQUAL CMAKE_CURRENT_LIST_FILE)
    set(_tpc_next_include "${CMAKE_PROJECT_INCLUDE}")
    set(CMAKE_PROJECT_INCLUDE "${CMAKE_CURRENT_LIST_FILE}")
  endif()
elseif(NOT _tpc_done)
  # Otherwise a project() inside the package, which has inherited the rules.
  _tpc_enter_project()
  if(_tpc_next_include)
    include("${_tpc_next_include}")
  endif()
endif()

cmake_policy(POP)
