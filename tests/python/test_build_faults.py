"""Why a package does not build, told from outputs as CMake, clang, lld and make write them."""

import pytest

from pytpc.build.fallback import first_error
from pytpc_evaluation.survey.missing_names import missing_names

CMAKE = """-- Found catkin
-- Could NOT find Doxygen (missing: DOXYGEN_EXECUTABLE)
CMake Warning at CMakeLists.txt:4 (find_package):
  Could not find a package configuration file provided by "qhull" with any of
  the following names:

CMake Error at CMakeLists.txt:9 (find_package):
  By not providing "FindPCL.cmake" in CMAKE_MODULE_PATH this project has asked
  CMake to find a package configuration file provided by "PCL".

  Could not find a package configuration file provided by "PCL" with any of
  the following names:

    PCLConfig.cmake

-- Configuring incomplete, errors occurred!
"""
CLANG = """In file included from /w/src/a.cpp:2:
/w/src/a.cpp:3:10: warning: unused error: handling
/w/src/a.cpp:4:10: fatal error: 'pcl/point_types.h' file not found
    4 | #include <pcl/point_types.h>
gmake[2]: *** [CMakeFiles/a.dir/build.make:76: CMakeFiles/a.dir/a.cpp.o] Error 1
"""


@pytest.mark.parametrize(
    ("output", "reason"),
    [
        (
            CMAKE,
            'CMake: CMakeLists.txt:9: By not providing "FindPCL.cmake" in CMAKE_MODULE_PATH this'
            ' project has asked CMake to find a package configuration file provided by "PCL".',
        ),
        (CLANG, "/w/src/a.cpp:4:10: fatal error: 'pcl/point_types.h' file not found"),
        (
            "ld.lld-19: error: undefined symbol: ros::init()\n>>> referenced by a.cpp\n",
            "ld.lld-19: error: undefined symbol: ros::init()",
        ),
        (
            "/usr/bin/ld: a.o: undefined reference to `f'\ngmake: *** [all] Error 2\n",
            "/usr/bin/ld: a.o: undefined reference to `f'",
        ),
        (
            "Traceback (most recent call last):\n  File x\nKeyError: 'a'\ngmake: *** [x] Error 1\n",
            "KeyError: 'a'",
        ),
        (
            "gmake: *** No rule to make target 'x'.  Stop.\nlast\n",
            "gmake: *** No rule to make target 'x'. Stop.",
        ),
        ("something else\n\n", "something else"),
        ("", "it says nothing"),
    ],
)
def test_the_reason_is_the_first_error(output: str, reason: str) -> None:
    assert first_error(output) == reason


def test_a_reason_is_one_line_of_bounded_length() -> None:
    assert len(first_error("a.cpp:1:1: error: " + "x" * 1000)) == 300


def test_what_is_missing_is_named_and_what_is_only_wished_for_is_not() -> None:
    assert missing_names(CMAKE) == ("PCL",)
    assert missing_names(CLANG) == ("pcl/point_types.h",)


@pytest.mark.parametrize(
    ("output", "name"),
    [
        (
            "CMake Error at F.cmake:230 (message):\n  Could NOT find Boost (missing: thread)\n",
            "Boost",
        ),
        ("--   No package 'libusb-1.0' found\n", "libusb-1.0"),
        ("ld.lld-19: error: unable to find library -lopencv_face\n", "opencv_face"),
        ("/usr/bin/ld: cannot find -lGLU: No such file or directory\n", "GLU"),
        ("ModuleNotFoundError: No module named 'numpy'\n", "numpy"),
        ("a.c:1:10: fatal error: zlib.h: No such file or directory\n", "zlib.h"),
    ],
)
def test_names(output: str, name: str) -> None:
    assert missing_names(output * 2) == (name,)
