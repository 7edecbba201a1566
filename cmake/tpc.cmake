# Builds a package with the passes of TPC. One file with three entrances:
#
#   -DCMAKE_TOOLCHAIN_FILE=.../tpc.cmake   what `pytpc build` does
#   -DCMAKE_PROJECT_INCLUDE=.../tpc.cmake  with the compilers chosen elsewhere
#   include(.../tpc.cmake)                 at the top of a CMakeLists.txt, as
#                                          `python -m pytpc.patch` puts it there
#
# Before project() it chooses the compilers; after it, it adds the flags to the
# targets of the package. What it cannot do it says in one warning, and leaves
# the build as it would have been.
#
#   TPC_CLANG_VERSION  release of clang, lld and LLVM (19)
#   TPC_RULES          the user's own file of rules
#   TPC_PROFILE        thesis or default
#   TPC_DISABLE        leave this package alone

cmake_policy(PUSH)
cmake_policy(VERSION 3.16)

get_filename_component(_tpc_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(_tpc_plugin "${_tpc_prefix}/lib/tpc/TpcPasses.so")
set(_tpc_log "${_tpc_prefix}/lib/libtpc_log.so")
if(NOT TPC_CLANG_VERSION)
  set(TPC_CLANG_VERSION 19)
endif()

# Chooses clang and LLVM's archiver, where nobody has chosen another compiler.
macro(_tpc_choose_compilers)
  find_program(TPC_CLANG clang-${TPC_CLANG_VERSION})
  find_program(TPC_CLANGXX clang++-${TPC_CLANG_VERSION})
  find_program(TPC_AR llvm-ar-${TPC_CLANG_VERSION})
  find_program(TPC_RANLIB llvm-ranlib-${TPC_CLANG_VERSION})
  if(TPC_CLANG AND TPC_CLANGXX AND TPC_AR AND TPC_RANLIB)
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
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    set(_tpc_obstacle "the compiler is ${CMAKE_CXX_COMPILER_ID}, not clang (a build folder keeps its compiler: remove ${CMAKE_BINARY_DIR})")
  elseif(NOT CMAKE_CXX_COMPILER_VERSION MATCHES "^${TPC_CLANG_VERSION}\\.")
    set(_tpc_obstacle "the compiler is clang ${CMAKE_CXX_COMPILER_VERSION}, the passes are for ${TPC_CLANG_VERSION}")
  elseif(NOT EXISTS "${_tpc_plugin}")
    set(_tpc_obstacle "${_tpc_plugin} is not there")
  elseif(NOT EXISTS "${_tpc_log}")
    set(_tpc_obstacle "${_tpc_log} is not there")
  else()
    find_program(TPC_LLD ld.lld-${TPC_CLANG_VERSION})
    if(NOT TPC_LLD)
      set(_tpc_obstacle "ld.lld-${TPC_CLANG_VERSION} is not here (apt-get install lld-${TPC_CLANG_VERSION})")
    endif()
  endif()
endmacro()

# Adds the flags to every target of this directory and those below. They are
# options, not libraries, so nothing of them is exported or inherited.
macro(_tpc_instrument)
  # The compiler leaves its optimisation to the link, where the analysis comes
  # first and the optimisation follows at the level that was asked for; the
  # level is read from the recorded command line.
  add_compile_options(
    "$<$<COMPILE_LANGUAGE:C,CXX>:SHELL:-g -flto=full -Xclang -disable-llvm-passes -grecord-command-line>")
  set(_tpc_options
    "-tpc-link-unit=$<TARGET_PROPERTY:NAME>"
    "-tpc-package=${PROJECT_NAME}"
    "-tpc-source-root=${CMAKE_SOURCE_DIR}"
    "-tpc-exclude=${CMAKE_BINARY_DIR}"
    "-tpc-static-info=${CMAKE_BINARY_DIR}/tpc/$<TARGET_PROPERTY:NAME>.json")
  if(TPC_PROFILE)
    list(APPEND _tpc_options "-tpc-profile=${TPC_PROFILE}")
  endif()
  if(TPC_RULES)
    list(APPEND _tpc_options "-tpc-rules=${TPC_RULES}")
  endif()
  add_link_options(
    "$<$<LINK_LANGUAGE:C,CXX>:-flto=full>"
    "$<$<LINK_LANGUAGE:C,CXX>:--ld-path=${TPC_LLD}>"
    "$<$<LINK_LANGUAGE:C,CXX>:LINKER:--load-pass-plugin=${_tpc_plugin}>"
    # Options of a plugin are known only once it is loaded this way as well.
    "$<$<LINK_LANGUAGE:C,CXX>:LINKER:-mllvm,-load=${_tpc_plugin}>"
    "$<$<LINK_LANGUAGE:C,CXX>:LINKER:-rpath,${_tpc_prefix}/lib>")
  foreach(_tpc_option IN LISTS _tpc_options)
    add_link_options("$<$<LINK_LANGUAGE:C,CXX>:LINKER:-mllvm,${_tpc_option}>")
  endforeach()
  # At the end of every link line; left out of what reports nothing.
  foreach(_tpc_language C CXX)
    string(APPEND CMAKE_${_tpc_language}_STANDARD_LIBRARIES
      " -Wl,--push-state,--as-needed \"${_tpc_log}\" -Wl,--pop-state")
  endforeach()
  cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}"
    CALL _tpc_relink_with_passes "${CMAKE_SOURCE_DIR}" "${_tpc_plugin}" "${_tpc_log}")
endmacro()

# Links again what is in the folder and those below when the passes or the log
# library have changed. Called at the end of the package's CMakeLists.txt.
function(_tpc_relink_with_passes folder)
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type "${target}" TYPE)
    if(type MATCHES "^(EXECUTABLE|SHARED_LIBRARY|MODULE_LIBRARY)$")
      set_property(TARGET "${target}" APPEND PROPERTY LINK_DEPENDS ${ARGN})
    endif()
  endforeach()
  get_property(folders DIRECTORY "${folder}" PROPERTY SUBDIRECTORIES)
  foreach(below IN LISTS folders)
    _tpc_relink_with_passes("${below}" ${ARGN})
  endforeach()
endfunction()

get_property(_tpc_probe GLOBAL PROPERTY IN_TRY_COMPILE)
if(TPC_DISABLE OR _tpc_probe)
  # Probes of the compiler are nobody's program; they only need the compiler.
  if(NOT PROJECT_NAME OR NOT CMAKE_CXX_COMPILER_ID)
    _tpc_choose_compilers()
  endif()
elseif(_tpc_done)
  # A project() inside the package: it has inherited the flags.
elseif(CMAKE_CXX_COMPILER_ID)
  set(_tpc_done TRUE)
  _tpc_find_obstacle()
  if(_tpc_obstacle)
    message(WARNING "TPC: ${PROJECT_NAME} is built without instrumentation: ${_tpc_obstacle}")
  else()
    _tpc_instrument()
  endif()
  if(_tpc_next_include)
    include("${_tpc_next_include}")
  endif()
else()
  _tpc_choose_compilers()
  # One file only can be included after project(): ours, which then includes
  # the one that was asked for.
  if(NOT CMAKE_PROJECT_INCLUDE STREQUAL CMAKE_CURRENT_LIST_FILE)
    set(_tpc_next_include "${CMAKE_PROJECT_INCLUDE}")
    set(CMAKE_PROJECT_INCLUDE "${CMAKE_CURRENT_LIST_FILE}")
  endif()
endif()

cmake_policy(POP)
