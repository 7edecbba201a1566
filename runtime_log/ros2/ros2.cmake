# ROS 2 is a folder with include/PACKAGE and lib: that of a distribution, or an environment of Python with
# the wheels.
set(TPC_ROS2_PREFIX "" CACHE PATH "The folder of ROS 2 to build libtpc_log_ros2.so for; found if it is empty")
string(REPLACE ":" ";" tpc_ros2_sourced "$ENV{AMENT_PREFIX_PATH}:$ENV{CMAKE_PREFIX_PATH}")
list(APPEND tpc_ros2_sourced ${CMAKE_PREFIX_PATH})
list(FILTER tpc_ros2_sourced EXCLUDE REGEX "^$")
set(tpc_ros2_places ${TPC_ROS2_PREFIX})
if(NOT tpc_ros2_places)
  file(GLOB tpc_ros2_installed /opt/ros/*)
  set(tpc_ros2_places ${tpc_ros2_sourced} ${tpc_ros2_installed}
    ${CMAKE_CURRENT_SOURCE_DIR}/../.venv-ros2)
endif()
set(TPC_ROS2 "")
foreach(place IN LISTS tpc_ros2_places)
  if(NOT TPC_ROS2 AND EXISTS "${place}/include/rcl/rcl/rcl.h" AND EXISTS "${place}/lib/librcl.so"
      AND EXISTS "${place}/share/rcl/package.xml")
    set(TPC_ROS2 "${place}")
  endif()
endforeach()
if(NOT TPC_ROS2)
  message(STATUS "No ROS 2 here: libtpc_log_ros2.so is not built (TPC_ROS2_PREFIX names its folder)")
  return()
endif()

# The structures of rcl differ between its major versions.
file(STRINGS "${TPC_ROS2}/share/rcl/package.xml" tpc_rcl_version REGEX "<version>")
string(REGEX REPLACE ".*<version>([0-9]+)\\..*" "\\1" tpc_rcl_version "${tpc_rcl_version}")
if(tpc_rcl_version LESS 5)
  message(STATUS "rcl ${tpc_rcl_version} in ${TPC_ROS2} is too old: libtpc_log_ros2.so is not built")
  return()
endif()

# In a ROS 2 built by colcon without --merge-install, each package has a folder of its own. All of
# them are sourced.
set(tpc_ros2_folders "${TPC_ROS2}" ${tpc_ros2_sourced})
set(tpc_ros2_libraries "")
foreach(library rcl rcl_yaml_param_parser rcutils rmw rosidl_runtime_c
    rcl_interfaces__rosidl_typesupport_c rcl_interfaces__rosidl_generator_c
    std_msgs__rosidl_typesupport_c std_msgs__rosidl_generator_c)
  set(found "")
  foreach(folder IN LISTS tpc_ros2_folders)
    if(NOT found AND EXISTS "${folder}/lib/lib${library}.so")
      set(found "${folder}/lib/lib${library}.so")
    endif()
  endforeach()
  if(NOT found)
    message(STATUS "lib${library}.so is not beside rcl in ${TPC_ROS2}, nor in a sourced folder:"
      " libtpc_log_ros2.so is not built")
    return()
  endif()
  list(APPEND tpc_ros2_libraries "${found}")
endforeach()
message(STATUS "ROS 2 in ${TPC_ROS2}, with rcl ${tpc_rcl_version}")

tpc_library(tpc_log_ros2
  Config.cpp
  HostCalls.cpp
  Report.cpp
  ros2/Arguments.cpp
  ros2/RclChannel.cpp
  ros2/RclGraph.cpp
  ros2/Ros2.cpp
  ros2/Settings.cpp
)
foreach(folder IN LISTS tpc_ros2_folders)
  file(GLOB packages RELATIVE "${folder}/include" "${folder}/include/*")
  foreach(package IN LISTS packages)
    if(IS_DIRECTORY "${folder}/include/${package}/${package}")
      target_include_directories(tpc_log_ros2 SYSTEM PRIVATE "${folder}/include/${package}")
    endif()
  endforeach()
endforeach()
target_compile_definitions(tpc_log_ros2 PRIVATE TPC_RCL_VERSION=${tpc_rcl_version})
# They are named as the process has them, wherever that has them from.
target_link_libraries(tpc_log_ros2 PRIVATE ${tpc_ros2_libraries})
target_link_options(tpc_log_ros2 PRIVATE -Wl,--allow-shlib-undefined)
set_target_properties(tpc_log_ros2 PROPERTIES SKIP_BUILD_RPATH ON)
