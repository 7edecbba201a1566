# ROS 2 is a folder with include/PACKAGE and lib: that of a distribution, or an environment of Python with
# the wheels.
set(TPC_ROS2_PREFIX "" CACHE PATH "The folder of ROS 2 to build libtpc_log_ros2.so for; found if it is empty")
set(tpc_ros2_places ${TPC_ROS2_PREFIX})
if(NOT tpc_ros2_places)
  string(REPLACE ":" ";" tpc_ros2_places "$ENV{AMENT_PREFIX_PATH}:$ENV{CMAKE_PREFIX_PATH}")
  file(GLOB tpc_ros2_installed /opt/ros/*)
  list(APPEND tpc_ros2_places ${CMAKE_PREFIX_PATH} ${tpc_ros2_installed}
    ${CMAKE_CURRENT_SOURCE_DIR}/../.venv-ros2)
endif()
set(TPC_ROS2 "")
foreach(place IN LISTS tpc_ros2_places)
  if(NOT TPC_ROS2 AND EXISTS "${place}/include/rcl/rcl/rcl.h" AND EXISTS "${place}/lib/librcl.so")
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
file(GLOB tpc_ros2_packages RELATIVE "${TPC_ROS2}/include" "${TPC_ROS2}/include/*")
foreach(package IN LISTS tpc_ros2_packages)
  if(IS_DIRECTORY "${TPC_ROS2}/include/${package}/${package}")
    target_include_directories(tpc_log_ros2 SYSTEM PRIVATE "${TPC_ROS2}/include/${package}")
  endif()
endforeach()
target_compile_definitions(tpc_log_ros2 PRIVATE TPC_RCL_VERSION=${tpc_rcl_version})
# They are named as the process has them, wherever that has them from.
foreach(library rcl rcl_yaml_param_parser rcutils rmw rosidl_runtime_c
    rcl_interfaces__rosidl_typesupport_c rcl_interfaces__rosidl_generator_c
    std_msgs__rosidl_typesupport_c std_msgs__rosidl_generator_c)
  target_link_libraries(tpc_log_ros2 PRIVATE "${TPC_ROS2}/lib/lib${library}.so")
endforeach()
target_link_options(tpc_log_ros2 PRIVATE -Wl,--allow-shlib-undefined)
set_target_properties(tpc_log_ros2 PROPERTIES SKIP_BUILD_RPATH ON)
