# Part of tpc.cmake, which includes it: chooses the compilers, and finds out what keeps a package
# from being instrumented.

# Sets `found` to the first flag in `text` that makes the compiler instrument the code itself. The
# compiler would do so in the passes that TPC postpones, so the flag would be lost silently.
function(_tpc_find_sanitizer text found)
  set(pattern "-fsanitize=[^ ]+|--coverage|-ftest-coverage|-fcoverage-mapping|-fprofile-[^ ]+")
  if(text MATCHES "(^| )(${pattern})")
    set(${found} "${CMAKE_MATCH_2}" PARENT_SCOPE)
  else()
    set(${found} "" PARENT_SCOPE)
  endif()
endfunction()

# Sets _tpc_sanitizer to such a flag among the flags for all targets of the package,
# _tpc_sanitizer_place to the variable that holds it and _tpc_sanitizer_flags to all flags in it.
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
    # Before project() the variables do not yet contain the environment.
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

# Sets `links` to whether clang links a program with these flags: a sanitizer needs libclang-rt-dev,
# which gcc does not need.
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

# Sets `lacks` to whether the list files of a folder mention OpenMP and clang has none: gcc includes
# its own, clang's is a package of its own. In a folder of packages only its own file counts: each
# package is checked when it is entered.
function(_tpc_lacks_openmp folder lacks)
  set(${lacks} FALSE PARENT_SCOPE)
  set(files "${folder}/CMakeLists.txt")
  file(GLOB packages "${folder}/*/package.xml" "${folder}/*/*/package.xml")
  if(NOT packages)
    file(GLOB below "${folder}/*/CMakeLists.txt" "${folder}/cmake/*.cmake")
    list(APPEND files ${below})
  endif()
  foreach(file IN LISTS files)
    if(EXISTS "${file}")
      file(STRINGS "${file}" speaks REGEX "^[^#]*(OpenMP|-fopenmp)")
      if(speaks)
        _tpc_try_clang("-fopenmp" links)
        if(NOT links)
          set(${lacks} TRUE PARENT_SCOPE)
        endif()
        return()
      endif()
    endif()
  endforeach()
endfunction()

macro(_tpc_find_compilers)
  find_program(TPC_CLANG clang-${TPC_CLANG_VERSION})
  find_program(TPC_CLANGXX clang++-${TPC_CLANG_VERSION})
  find_program(TPC_AR llvm-ar-${TPC_CLANG_VERSION})
  find_program(TPC_RANLIB llvm-ranlib-${TPC_CLANG_VERSION})
  find_program(TPC_LLD ld.lld-${TPC_CLANG_VERSION})
endmacro()

# Chooses clang and LLVM's archiver, unless another compiler was chosen. A package with a sanitizer
# or OpenMP that clang cannot link keeps its compiler.
macro(_tpc_choose_compilers)
  _tpc_find_compilers()
  set(_tpc_clang_links TRUE)
  _tpc_find_sanitizer_of_package()
  if(TPC_CLANG AND _tpc_sanitizer AND NOT _tpc_probe)
    _tpc_try_clang("${_tpc_sanitizer_flags}" _tpc_clang_links)
  elseif(TPC_CLANG AND NOT _tpc_probe)
    _tpc_lacks_openmp("${CMAKE_SOURCE_DIR}" _tpc_openmp)
    if(_tpc_openmp)
      set(_tpc_clang_links FALSE)
    endif()
  endif()
  if(NOT _tpc_clang_links)
    # _tpc_find_obstacle gives the reason.
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
      # Objects made with gcc's own -flto need gcc's archiver.
      if(CMAKE_${_tpc_language}_COMPILER MATCHES "clang")
        set(CMAKE_${_tpc_language}_COMPILER_AR "${TPC_AR}")
        set(CMAKE_${_tpc_language}_COMPILER_RANLIB "${TPC_RANLIB}")
      endif()
    endforeach()
  else()
    message(WARNING "TPC: clang ${TPC_CLANG_VERSION} is not installed; this package is built without TPC "
      "(apt-get install clang-${TPC_CLANG_VERSION} lld-${TPC_CLANG_VERSION} llvm-${TPC_CLANG_VERSION})")
  endif()
endmacro()

# Sets `result` to whether the user named the compiler of a language: by default CMake chooses cc
# and c++.
function(_tpc_is_chosen_by_hand language result)
  get_filename_component(name "${CMAKE_${language}_COMPILER}" NAME)
  get_property(help CACHE CMAKE_${language}_COMPILER PROPERTY HELPSTRING)
  if(help MATCHES "specified on the command line" OR CMAKE_TOOLCHAIN_FILE
      OR NOT name MATCHES "^(cc|c\\+\\+)$")
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# If gcc builds the package, it is built as before. If clang was already chosen for all packages of
# a workspace together, a warning is all that can be done.
macro(_tpc_find_openmp_obstacle)
  _tpc_lacks_openmp("${CMAKE_CURRENT_SOURCE_DIR}" _tpc_openmp)
  set(_tpc_openmp_mend "apt-get install libomp-${TPC_CLANG_VERSION}-dev, and remove the build folder")
  if(_tpc_openmp AND (CMAKE_C_COMPILER_ID STREQUAL "Clang" OR CMAKE_CXX_COMPILER_ID STREQUAL "Clang"))
    message(WARNING "TPC: ${_tpc_name} uses OpenMP, and clang's OpenMP is not installed: it is built "
      "without OpenMP, or fails (${_tpc_openmp_mend})")
  elseif(_tpc_openmp)
    set(_tpc_obstacle "it uses OpenMP, and clang's OpenMP is not installed (${_tpc_openmp_mend})")
  endif()
endmacro()

# Sets _tpc_obstacle to why the package cannot be instrumented; empty if it can.
macro(_tpc_find_obstacle)
  set(_tpc_obstacle "")
  if(NOT TPC_LLD)
    set(_tpc_obstacle "ld.lld-${TPC_CLANG_VERSION} is not installed (apt-get install lld-${TPC_CLANG_VERSION})")
  endif()
  foreach(_tpc_part IN ITEMS "${_tpc_flags_file}" "${_tpc_defer}" "${_tpc_plugin}" "${_tpc_log}")
    if(NOT EXISTS "${_tpc_part}")
      set(_tpc_obstacle "${_tpc_part} is missing")
    endif()
  endforeach()
  if(NOT TPC_CLANG_VERSION STREQUAL _tpc_release)
    set(_tpc_obstacle "TPC_CLANG_VERSION is ${TPC_CLANG_VERSION}, and the plugins are for clang ${_tpc_release}")
  endif()
  foreach(_tpc_language IN LISTS _tpc_languages)
    _tpc_is_chosen_by_hand(${_tpc_language} _tpc_by_hand)
    if(CMAKE_${_tpc_language}_COMPILER_ID STREQUAL "GNU" AND NOT _tpc_by_hand
        AND TPC_CLANG AND TPC_CLANGXX AND TPC_AR AND TPC_RANLIB)
      # CMake chose it, not the user: clang can replace it, see _tpc_replace_compilers.
    elseif(NOT CMAKE_${_tpc_language}_COMPILER_ID STREQUAL "Clang")
      set(_tpc_obstacle "the compiler is ${CMAKE_${_tpc_language}_COMPILER_ID}, not clang")
    elseif(NOT CMAKE_${_tpc_language}_COMPILER_VERSION MATCHES "^${TPC_CLANG_VERSION}\\.")
      set(_tpc_obstacle "the compiler is clang ${CMAKE_${_tpc_language}_COMPILER_VERSION}, the passes are for ${TPC_CLANG_VERSION}")
    endif()
  endforeach()
  if(TPC_CLANG)
    _tpc_find_openmp_obstacle()
  endif()
  _tpc_find_sanitizer_of_package()
  if(_tpc_sanitizer)
    set(_tpc_obstacle "${_tpc_sanitizer} in ${_tpc_sanitizer_place} cannot be combined with TPC")
  endif()
  if(TPC_DISABLE)
    set(_tpc_obstacle "TPC_DISABLE is set")
  endif()
endmacro()
