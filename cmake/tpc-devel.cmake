# Part of tpc.cmake, which includes it: lets a package find other packages of the workspace that no
# install() rule installs completely. Most workspaces of catkin are built without such rules, since
# catkin_make does not install: there each package is found in its devel space. `pytpc build`
# installs packages, so that the configuration of such a package names folders and libraries that
# are not there.
#
#   TPC_BASE  folder of `pytpc build`, with build/PACKAGE and install/PACKAGE

# Sets PACKAGE_DIR, where find_package() looks first, to the devel space of each package of which
# the installed files are incomplete.
function(_tpc_find_devel_spaces)
  file(GLOB configs "${TPC_BASE}/build/*/devel/share/*/cmake/*Config.cmake")
  foreach(config IN LISTS configs)
    get_filename_component(folder "${config}" DIRECTORY)
    get_filename_component(name "${config}" NAME)
    string(REGEX REPLACE "Config\\.cmake$" "" name "${name}")
    set(installed "${TPC_BASE}/install/${name}")
    if(NOT folder STREQUAL "${TPC_BASE}/build/${name}/devel/share/${name}/cmake"
        OR NOT EXISTS "${installed}/share/${name}/cmake/${name}Config.cmake")
      continue()
    endif()
    _tpc_is_installed("${name}" "${installed}" is_installed)
    if(NOT is_installed)
      set(${name}_DIR "${folder}" PARENT_SCOPE)
    elseif("$CACHE{${name}_DIR}" STREQUAL folder)
      # It has rules now.
      unset(${name}_DIR CACHE)
    endif()
  endforeach()
endfunction()

# Whether all that a catkin package gives to others was installed: its headers, and the libraries
# that it names in catkin_package() and has built.
function(_tpc_is_installed name installed result)
  set(${result} TRUE PARENT_SCOPE)
  set(devel "${TPC_BASE}/build/${name}/devel")
  if(NOT EXISTS "${devel}/.catkin")
    return()
  endif()
  file(READ "${devel}/.catkin" source)
  set(config "${installed}/share/${name}/cmake/${name}Config.cmake")
  file(STRINGS "${config}" lines REGEX "^ *set\\((_include_dirs|libraries) \".*\"\\)$")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^ *set\\([a-z_]+ \"(.*)\"\\)$" "\\1" values "${line}")
    if(line MATCHES "^ *set\\(libraries")
      foreach(library IN LISTS values)
        file(GLOB built "${devel}/lib/lib${library}.*")
        file(GLOB found "${installed}/lib/lib${library}.*")
        if(built AND NOT found)
          set(${result} FALSE PARENT_SCOPE)
        endif()
      endforeach()
    elseif("include" IN_LIST values)
      file(GLOB_RECURSE headers RELATIVE "${source}/include" "${source}/include/*")
      foreach(header IN LISTS headers)
        if(NOT EXISTS "${installed}/include/${header}")
          set(${result} FALSE PARENT_SCOPE)
        endif()
      endforeach()
    endif()
  endforeach()
endfunction()
