# ROS 1 is found by its package files, which Debian installs.
find_package(PkgConfig)
if(PKG_CONFIG_FOUND)
  pkg_check_modules(ROS roscpp rosconsole rosgraph_msgs std_msgs std_srvs)
endif()
if(NOT ROS_FOUND)
  message(STATUS "No ROS 1 here: libtpc_log_ros1.so is not built")
  return()
endif()
# Those of Debian 13 have an empty prefix, so that they name /include.
set(TPC_ROS_INCLUDES)
foreach(folder IN LISTS ROS_INCLUDE_DIRS)
  if(IS_DIRECTORY "${folder}")
    list(APPEND TPC_ROS_INCLUDES "${folder}")
  endif()
endforeach()

tpc_library(tpc_log_ros1
  Config.cpp
  HostCalls.cpp
  ros1/Ros1.cpp
  ros1/RosChannel.cpp
  ros1/RosControl.cpp
  ros1/RosLife.cpp
  ros1/RosNames.cpp
)
target_include_directories(tpc_log_ros1 PRIVATE ${TPC_ROS_INCLUDES})
target_compile_options(tpc_log_ros1 PRIVATE ${ROS_CFLAGS_OTHER})
target_link_libraries(tpc_log_ros1 PRIVATE ${ROS_LINK_LIBRARIES})
target_link_options(tpc_log_ros1 PRIVATE ${ROS_LDFLAGS_OTHER})
