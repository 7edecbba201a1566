# Part of tpc.cmake, which includes it: what is worked out for each target when all
# of them are known, at the end of the top CMakeLists.txt.
#
# tpc.cmake's link options read these properties of a target:
#
#   _TPC_OFF  why it is neither analysed nor reporting; empty where it is
#   _TPC_PACKAGE, _TPC_SOURCE_ROOT, _TPC_EXCLUDED, _TPC_STATIC_INFO
#
# Every link unit is listed in <build folder>/tpc/targets.tsv, with its file and the
# reason why it is left out, if it is: so that nothing is missing silently.
#
# The functions run in the scope of the top CMakeLists.txt, which need not have read
# this file: they know no variables but those of the folders that they ask.

function(_tpc_finish)
  set_property(GLOBAL PROPERTY _tpc_listed "")
  _tpc_finish_folder("${CMAKE_SOURCE_DIR}")
  get_property(listed GLOBAL PROPERTY _tpc_listed)
  # Of several configurations the first one's files stand for all, as in CMake's answer.
  set(condition 1)
  get_property(several GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(several)
    list(GET CMAKE_CONFIGURATION_TYPES 0 first)
    set(condition "$<CONFIG:${first}>")
  endif()
  file(GENERATE OUTPUT "${CMAKE_BINARY_DIR}/tpc/targets.tsv" CONTENT "${listed}"
    CONDITION "${condition}")
  # CMake answers in the configuration after this one.
  if(NOT EXISTS "${CMAKE_BINARY_DIR}/.cmake/api/v1/query/codemodel-v2")
    file(WRITE "${CMAKE_BINARY_DIR}/.cmake/api/v1/query/codemodel-v2" "")
  endif()
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
  get_directory_property(obstacle DIRECTORY "${folder}" DEFINITION _tpc_obstacle)
  _tpc_find_plain_sources("${folder}" plain_sources)
  _tpc_find_package("${folder}")
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type "${target}" TYPE)
    if(NOT type MATCHES "^(EXECUTABLE|(SHARED|MODULE|STATIC|OBJECT)_LIBRARY)$")
      continue()
    endif()
    if(NOT obstacle)
      _tpc_find_lost_flag("${folder}" "${target}")
      get_property(options TARGET "${target}" PROPERTY COMPILE_OPTIONS)
      list(REMOVE_ITEM options "-ffat-lto-objects")
      set_property(TARGET "${target}" PROPERTY COMPILE_OPTIONS "${options}")
    endif()
    _tpc_has_plain_source("${target}" "${plain_sources}" is_plain)
    if(is_plain AND NOT obstacle)
      set_property(GLOBAL APPEND PROPERTY _tpc_plain "${target}")
    endif()
    if(NOT type MATCHES "^(STATIC|OBJECT)_LIBRARY$")
      _tpc_finish_link_unit("${folder}" "${target}" "${obstacle}" "${is_plain}")
    endif()
  endforeach()
endfunction()

# Sets package, root, binary and excluded to what folder's targets belong to: the
# nearest folder above with a package.xml, or else the top of the project.
macro(_tpc_find_package folder)
  set(root "${folder}")
  while(NOT EXISTS "${root}/package.xml" AND NOT root STREQUAL CMAKE_SOURCE_DIR)
    get_directory_property(root DIRECTORY "${root}" PARENT_DIRECTORY)
  endwhile()
  get_directory_property(package DIRECTORY "${root}" DEFINITION PROJECT_NAME)
  get_directory_property(binary DIRECTORY "${root}" BINARY_DIR)
  # What is generated is nobody's source, unless it is built where the sources are.
  set(excluded "${CMAKE_BINARY_DIR}")
  string(FIND "${root}/" "${CMAKE_BINARY_DIR}/" at)
  if(at EQUAL 0)
    set(excluded "${CMAKE_BINARY_DIR}/devel")
  endif()
endmacro()

# Sets `patterns` to those of the sources whose compile rule is not ours.
function(_tpc_find_plain_sources folder patterns)
  get_property(enabled GLOBAL PROPERTY ENABLED_LANGUAGES)
  get_directory_property(defer DIRECTORY "${folder}" DEFINITION _tpc_defer)
  set(suffixes_C "c")
  set(suffixes_CXX "C|cc|cpp|cxx|c\\+\\+|CPP")
  set(found "")
  foreach(language C CXX)
    get_directory_property(rule DIRECTORY "${folder}" DEFINITION CMAKE_${language}_COMPILE_OBJECT)
    string(FIND "${rule}" "${defer}" at)
    if(language IN_LIST enabled AND at EQUAL -1)
      list(APPEND found "\\.(${suffixes_${language}})$")
    endif()
  endforeach()
  set(${patterns} "${found}" PARENT_SCOPE)
endfunction()

function(_tpc_has_plain_source target patterns result)
  set(${result} FALSE PARENT_SCOPE)
  get_property(sources TARGET "${target}" PROPERTY SOURCES)
  foreach(pattern IN LISTS patterns)
    set(matching "${sources}")
    list(FILTER matching INCLUDE REGEX "${pattern}")
    if(matching)
      set(${result} TRUE PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

# Notes a flag of the target that would be lost. Flags in generator expressions and in
# the interface of another target are not known here.
function(_tpc_find_lost_flag folder target)
  get_property(all TARGET "${target}" PROPERTY COMPILE_FLAGS)
  get_property(options TARGET "${target}" PROPERTY COMPILE_OPTIONS)
  list(APPEND all "${options}")
  foreach(language C CXX)
    get_directory_property(common DIRECTORY "${folder}" DEFINITION CMAKE_${language}_FLAGS)
    list(APPEND all "${common}")
  endforeach()
  string(REGEX REPLACE ";(SHELL:)?" " " flags ";${all}")
  _tpc_find_sanitizer("${flags}" flag)
  if(flag)
    set_property(GLOBAL APPEND PROPERTY _tpc_lost "${flag} of ${target}")
  endif()
endfunction()

# Sets the properties of an executable or library, has it linked again when the passes,
# the log library or the rules have changed, and lists it.
function(_tpc_finish_link_unit folder target obstacle is_plain)
  _tpc_find_package("${folder}")
  set(left_out "${obstacle}")
  if(NOT left_out)
    _tpc_find_reason_to_leave_out("${folder}" "${target}" left_out)
  endif()
  set(file "${binary}/tpc/${target}.json")
  set_target_properties("${target}" PROPERTIES
    _TPC_OFF "${left_out}" _TPC_PACKAGE "${package}" _TPC_SOURCE_ROOT "${root}"
    _TPC_EXCLUDED "${excluded}" _TPC_STATIC_INFO "${file}")
  if(NOT obstacle)
    foreach(part _tpc_plugin _tpc_log _tpc_rules)
      get_directory_property(path DIRECTORY "${folder}" DEFINITION ${part})
      if(path AND EXISTS "${path}")
        set_property(TARGET "${target}" APPEND PROPERTY LINK_DEPENDS "${path}")
      endif()
    endforeach()
  endif()
  if(left_out)
    # What an earlier build found says nothing of what is built now.
    file(REMOVE "${file}")
  elseif(is_plain)
    set(left_out "the language was enabled after project(), or its compile rule was replaced")
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY _tpc_listed
    "${package}\t${target}\t$<TARGET_FILE:${target}>\t${file}\t${left_out}\n")
endfunction()

# Sets `reason` to why a target gets no reports in a package that does; empty where it
# gets them.
function(_tpc_find_reason_to_leave_out folder target reason)
  set(${reason} "" PARENT_SCOPE)
  get_target_property(wish "${target}" TPC_INSTRUMENT)
  if(NOT wish STREQUAL "wish-NOTFOUND")
    if(NOT wish)
      set(${reason} "its property TPC_INSTRUMENT is ${wish}" PARENT_SCOPE)
    endif()
    return()
  endif()
  _tpc_is_static("${folder}" "${target}" is_static)
  if(is_static)
    set(${reason} "it is linked with -static, and reports need a shared library" PARENT_SCOPE)
  endif()
  # Libraries that only a test program is linked with.
  string(CONCAT test_library
    "^(GTest::)?(gtest|gmock)(_main)?$|/lib(gtest|gmock)(_main)?\\.|^Catch2(::|$)|^doctest::"
    "|boost_unit_test_framework|Boost::(unit_test_framework|prg_exec_monitor)|^rosunit$")
  get_property(libraries TARGET "${target}" PROPERTY LINK_LIBRARIES)
  list(FILTER libraries INCLUDE REGEX "${test_library}")
  set(tests "")
  if(TARGET tests)
    get_property(tests TARGET tests PROPERTY MANUALLY_ADDED_DEPENDENCIES)
  endif()
  get_directory_property(with_tests DIRECTORY "${folder}" DEFINITION TPC_TESTS)
  if(NOT with_tests AND (libraries OR target IN_LIST tests))
    set(${reason} "it is a test (TPC_TESTS=ON has tests analysed, too)" PARENT_SCOPE)
  endif()
endfunction()

function(_tpc_is_static folder target result)
  get_target_property(type "${target}" TYPE)
  set(flags "")
  foreach(property LINK_FLAGS LINK_OPTIONS LINK_LIBRARIES)
    get_property(value TARGET "${target}" PROPERTY ${property})
    list(APPEND flags "${value}")
  endforeach()
  get_directory_property(common DIRECTORY "${folder}" DEFINITION CMAKE_EXE_LINKER_FLAGS)
  if(type STREQUAL "EXECUTABLE")
    list(APPEND flags "${common}")
  endif()
  if("${flags}" MATCHES "(^|[; ])-static(-pie)?($|[; ])")
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()
