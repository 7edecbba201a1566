"""tpc.cmake on small CMake projects without ROS: flags and languages of the package."""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import SYSTEM_PATH, cmake_file, log_library, plugin
from pytpc.build.reconcile import recorded_units
from pytpc.static.static_info import unit_files

try:
    for half in (cmake_file, plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

HEAD = "cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES CXX)\n"
MAIN = (
    "#include <string>\nint main(int n, char **v) { return std::string(v[0]).size() < 1u + n; }\n"
)
OTHER = "#include <string>\nstd::string other(int n) { return std::string(n, 'x'); }\n"
NOT_KEPT = {"CC", "CXX", "CFLAGS", "CXXFLAGS", "LDFLAGS", "TPC_PREFIX"}


@dataclass(frozen=True)
class Built:
    """A folder in which a project was built, and what CMake said when it configured it."""

    folder: Path
    said: str

    def warnings(self) -> list[str]:
        """TPC's warnings, each on one line."""
        blocks = self.said.split("CMake Warning")[1:]
        texts = (" ".join(block.split("Call Stack")[0].split()) for block in blocks)
        return [text[text.index("TPC: ") :] for text in texts if "TPC: " in text]

    def analysed(self) -> list[str]:
        """The link units that the passes have seen."""
        return sorted(path.stem for path in unit_files(self.folder))

    def manifests(self) -> list[str]:
        """The link units whose link can be repeated."""
        end = ".link.json"
        return sorted(path.name.removesuffix(end) for path in self.folder.glob(f"tpc/*{end}"))

    def runs(self, program: str) -> subprocess.CompletedProcess[str]:
        return run([self.folder / program])


def run(command: list[str | Path], **variables: str) -> subprocess.CompletedProcess[str]:
    kept = {name: value for name, value in os.environ.items() if name not in NOT_KEPT}
    return subprocess.run(
        command,
        env={**kept, "PATH": SYSTEM_PATH, **variables},
        capture_output=True,
        text=True,
        timeout=900,
        check=False,
    )


def toolchain() -> str:
    return f"-DCMAKE_TOOLCHAIN_FILE={cmake_file()}"


def build(root: Path, cmakelists: str, *arguments: str, name: str = "p", **variables: str) -> Built:
    """Configure and build; a failure shows what was said."""
    source, folder = root / name, root / f"build of {name}"
    source.mkdir(parents=True, exist_ok=True)
    (source / "CMakeLists.txt").write_text(cmakelists, encoding="utf-8")
    for file, text in (
        ("main.cpp", MAIN),
        ("other.cpp", OTHER),
        ("c.c", "int c(int a){return a;}"),
    ):
        (source / file).write_text(text, encoding="utf-8")
    command = ["cmake", "-G", "Ninja", "-S", source, "-B", folder, *(arguments or (toolchain(),))]
    configured = run(command, **variables)
    assert configured.returncode == 0, configured.stdout + configured.stderr
    made = run(["cmake", "--build", folder, "-j2"])
    assert made.returncode == 0, made.stdout
    return Built(folder, configured.stderr)


# --- flags of the package


@pytest.mark.parametrize("flag", ["-fno-lto", "-flto=thin", "-g0", "-ffat-lto-objects"])
def test_a_targets_own_flag_does_not_undo_the_build(tmp_path: Path, flag: str) -> None:
    lists = HEAD + "add_executable(x main.cpp other.cpp)\n"
    result = build(tmp_path, f"{lists}target_compile_options(x PRIVATE {flag})\n")
    assert (result.analysed(), result.warnings()) == (["x"], [])
    for path in result.folder.rglob("*.o"):
        shown = run(["llvm-dis-19", path, "-o", "-"]).stdout
        assert "!DISubprogram(" in shown


def test_a_warning_that_only_gcc_knows_is_no_error(tmp_path: Path) -> None:
    unused = "add_executable(x main.cpp unused.cpp)\n"
    (tmp_path / "p").mkdir()
    # clang alone warns of an unused private field.
    field = "class K { int k = 0; };\nK it;\n"
    (tmp_path / "p/unused.cpp").write_text(field, encoding="utf-8")
    options = "add_compile_options(-Wall -Wextra -Werror -Wno-maybe-uninitialized)\n"
    assert build(tmp_path, HEAD + options + unused).analysed() == ["x"]


# A constant in braces of a narrower type, a template without its arguments, a register variable.
ACCEPTED = """#include <string>
struct Inner { template <class T> int get() { return sizeof(T); } };
template <class T> int size(T inner) { return inner.template get<int>(); }
int wide(double value) { int narrow[] = {value}; return narrow[0]; }
int main(int n, char **v) {
  register int one = 1;
  return std::string(v[0]).size() < 1u + size(Inner()) * 0 + wide(n) * 0 + n * one;
}
"""


@pytest.mark.parametrize("disable", ["OFF", "ON"])
def test_what_gcc_accepts_and_clang_does_not_is_no_error(tmp_path: Path, disable: str) -> None:
    (tmp_path / "p").mkdir()
    (tmp_path / "p/accepted.cpp").write_text(ACCEPTED, encoding="utf-8")
    (tmp_path / "p/implicit.c").write_text("int twice(n) { return later(n); }\n", encoding="ascii")
    lists = (
        "cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES C CXX)\n"
        "include(CheckCSourceCompiles)\n"
        'check_c_source_compiles("int main(void) { return later(1); } int later(int n) '
        '{ return n; }" HAS)\nif(NOT HAS)\n  message(FATAL_ERROR no)\nendif()\n'
        "add_executable(x accepted.cpp)\nadd_library(c STATIC implicit.c)\n"
    )
    result = build(tmp_path, lists, toolchain(), f"-DTPC_DISABLE={disable}")
    assert result.analysed() == (["x"] if disable == "OFF" else [])


def test_the_level_and_the_macros_of_the_package_are_kept(tmp_path: Path) -> None:
    lists = (
        HEAD + "add_executable(x main.cpp)\ntarget_compile_options(x PRIVATE -g3 -fdebug-macro)\n"
    )
    result = build(tmp_path, lists, toolchain(), "-DCMAKE_BUILD_TYPE=Release")
    objects = [str(path) for path in result.folder.rglob("main.cpp.o")]
    shown = run(["llvm-dis-19", *objects, "-o", "-"]).stdout
    assert "DW_MACINFO_define" in shown
    # One compile line; what is recorded in it has the level of Release.
    assert " -O3 " in shown


def test_a_launcher_is_kept_and_the_flags_stand_once(tmp_path: Path) -> None:
    inner = "add_subdirectory(inner)\nadd_executable(x main.cpp)\n"
    (tmp_path / "p/inner").mkdir(parents=True)
    (tmp_path / "p/inner/CMakeLists.txt").write_text(
        "project(inner CXX)\nadd_executable(y ../main.cpp)\n", encoding="utf-8"
    )
    launcher = "-DCMAKE_CXX_COMPILER_LAUNCHER=/usr/bin/env"
    include = f'include("{cmake_file()}")\n'
    nice = tmp_path / "be nice"
    nice.symlink_to("/usr/bin/nice")
    linking = f"-DCMAKE_CXX_LINKER_LAUNCHER={nice};-n1"
    result = build(tmp_path, include + HEAD + inner, toolchain(), launcher, linking)
    assert result.analysed() == ["x", "y"]
    lines = run(["ninja", "-C", result.folder, "-t", "commands"]).stdout.splitlines()
    compiled = [line for line in lines if " -c " in line]
    assert len(compiled) == 2
    for line in compiled:
        assert line.startswith("/usr/bin/env ")
        assert line.count("-fpass-plugin=") == 1
    linked = [line for line in lines if "--load-pass-plugin=" in line]
    assert len(linked) == 2
    assert all(line.count(f'"{nice}" "-n1" ') == 1 for line in linked)


def test_what_is_installed_finds_the_log_and_is_linked_again_with_new_passes(
    tmp_path: Path,
) -> None:
    lists = HEAD + "add_executable(x main.cpp)\ninstall(TARGETS x)\n"
    result = build(tmp_path, lists, toolchain(), f"-DCMAKE_INSTALL_PREFIX={tmp_path}/i")
    inputs = run(["ninja", "-C", result.folder, "-t", "query", "x"]).stdout
    assert str(plugin()) in inputs
    assert str(log_library()) in inputs
    assert run(["cmake", "--install", result.folder]).returncode == 0
    dynamic = run(["readelf", "-d", tmp_path / "i/bin/x"]).stdout
    (path,) = [line for line in dynamic.splitlines() if "RUNPATH" in line]
    assert str(log_library().parent) in path


def test_a_precompiled_header_is_compiled_alike(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\ntarget_precompile_headers(x PRIVATE <string>)\n"
    assert build(tmp_path, lists).analysed() == ["x"]


# --- what is linked without the passes


LIBRARY = """cmake_minimum_required(VERSION 3.16)
project(lib LANGUAGES CXX)
add_library(lib STATIC other.cpp)
"""
USER = """cmake_minimum_required(VERSION 3.16)
project(p LANGUAGES CXX)
include(CheckCXXSourceCompiles)
set(CMAKE_EXE_LINKER_FLAGS "-Wl,--no-undefined")
set(CMAKE_REQUIRED_LIBRARIES "${LIB}")
check_cxx_source_compiles("#include <string>
std::string other(int); int main() { return other(1).size() == 2; }" FOUND)
if(NOT FOUND)
  message(FATAL_ERROR "the probe cannot link")
endif()
add_library(s SHARED user.cpp)
target_link_libraries(s "${LIB}")
add_executable(x main.cpp user.cpp)
target_link_libraries(x "${LIB}")
"""


@pytest.mark.parametrize("disable", [False, True])
@pytest.mark.parametrize("entrance", ["toolchain", "project_include", "include"])
def test_a_static_library_with_bitcode_can_be_linked(
    tmp_path: Path, entrance: str, disable: bool
) -> None:
    library = build(
        tmp_path, LIBRARY, f"{toolchain()}", "-DCMAKE_POSITION_INDEPENDENT_CODE=ON", name="lib"
    )
    (tmp_path / "p").mkdir()
    user = "#include <string>\nstd::string other(int);\nint user() { return other(3).size(); }\n"
    (tmp_path / "p/user.cpp").write_text(user, encoding="utf-8")
    arguments = [f"-DLIB={library.folder}/liblib.a", "-DCMAKE_POSITION_INDEPENDENT_CODE=ON"]
    lists = USER
    if entrance == "toolchain":
        arguments.append(toolchain())
    elif entrance == "include":
        lists = f'include("{cmake_file()}" OPTIONAL)\n' + USER
    elif disable:
        pytest.skip("a compiler that somebody else chose is left as it is")
    else:
        arguments += [f"-DCMAKE_PROJECT_INCLUDE={cmake_file()}", "-DCMAKE_CXX_COMPILER=clang++-19"]
    if disable:
        arguments.append("-DTPC_DISABLE=ON")
    result = build(tmp_path, lists, *arguments)
    assert result.analysed() == ([] if disable else ["s", "x"])
    assert result.runs("x").returncode == 0
    # A second configuration comes to the same.
    assert build(tmp_path, lists, *arguments).analysed() == result.analysed()


def test_other_languages_do_not_get_the_flags_of_lld(tmp_path: Path) -> None:
    lists = HEAD + 'file(WRITE "${CMAKE_BINARY_DIR}/l" "${CMAKE_EXE_LINKER_FLAGS}")\n'
    result = build(tmp_path, lists)
    assert "ld-path" not in (result.folder / "l").read_text(encoding="utf-8")


# --- sanitizers and profiles


OVERRUN = """#include <cstdlib>
int main(int c, char **) {
  int *p = (int *)std::malloc(4 * c); p[c] = 1; int r = p[c]; std::free(p); return r;
}
"""


@pytest.mark.parametrize("place", ["CMAKE_CXX_FLAGS", "CMAKE_CXX_FLAGS_DEBUG", "CXXFLAGS"])
def test_a_sanitizer_works_in_a_package_that_is_left_alone(tmp_path: Path, place: str) -> None:
    (tmp_path / "p").mkdir()
    (tmp_path / "p/overrun.cpp").write_text(OVERRUN, encoding="utf-8")
    flag = "-fsanitize=address"
    lists = HEAD + "add_executable(x overrun.cpp)\n"
    if place == "CXXFLAGS":
        result = build(tmp_path, lists, CXXFLAGS=f"-Wall {flag}")
        place = "CMAKE_CXX_FLAGS"
    else:
        debug = "-DCMAKE_BUILD_TYPE=Debug"
        result = build(tmp_path, lists, toolchain(), debug, f"-D{place}=-Wall {flag}")
    (warning,) = result.warnings()
    reason = f"{flag} in {place} cannot be combined with TPC"
    assert warning.startswith(f"TPC: p is built without instrumentation: {reason}")
    assert "heap-buffer-overflow" in result.runs("x").stderr
    assert result.analysed() == []


def test_a_profile_is_written(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\n"
    result = build(tmp_path, lists, toolchain(), "-DCMAKE_CXX_FLAGS=--coverage")
    (warning,) = result.warnings()
    assert "--coverage in CMAKE_CXX_FLAGS cannot be combined with TPC" in warning
    assert result.runs("x").returncode in (0, 1)
    assert [*result.folder.rglob("*.gcda")]


def test_a_sanitizer_that_clang_can_link_stays_with_clang(tmp_path: Path) -> None:
    # It needs no library of clang's: the program is ended by an illegal instruction.
    trap = "-fsanitize=undefined -fsanitize-trap=undefined"
    (tmp_path / "p").mkdir()
    overflow = "int main(int n, char **) { return (0x7fffffff + n) / 2; }\n"
    (tmp_path / "p/overflow.cpp").write_text(overflow, encoding="utf-8")
    lists = HEAD + "add_executable(x overflow.cpp)\n"
    result = build(tmp_path, lists, toolchain(), f"-DCMAKE_CXX_FLAGS={trap}")
    (warning,) = result.warnings()
    assert "-fsanitize=undefined in CMAKE_CXX_FLAGS cannot be combined with TPC" in warning
    assert result.runs("x").returncode < 0
    compilers = [path.read_text("utf-8") for path in result.folder.rglob("CMakeCXXCompiler.cmake")]
    assert 'set(CMAKE_CXX_COMPILER "/usr/bin/clang++-19")' in compilers[0]


def test_a_sanitizer_of_another_configuration_is_no_obstacle(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\n"
    arguments = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_DEBUG=-fsanitize=address"]
    result = build(tmp_path, lists, toolchain(), *arguments)
    assert (result.analysed(), result.warnings()) == (["x"], [])


def test_a_sanitizer_that_comes_after_project_is_said_to_be_lost(tmp_path: Path) -> None:
    lists = HEAD + (
        "add_library(x STATIC main.cpp)\ntarget_compile_options(x PRIVATE -fsanitize=address)\n"
        "add_library(y STATIC main.cpp)\n"
    )
    (warning,) = build(tmp_path, lists).warnings()
    lost = "-fsanitize=address of x; -DTPC_DISABLE=ON keeps it"
    assert warning.startswith(f"TPC: has no effect in a build with TPC: {lost}")
    late = 'set(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS} --coverage")\n'
    lists = f"{HEAD}{late}add_library(z STATIC main.cpp)\n"
    (warning,) = build(tmp_path, lists, name="late").warnings()
    assert "--coverage of z; " in warning


# --- languages


@pytest.mark.parametrize(
    ("first", "then", "source"), [("C", "CXX", "main.cpp"), ("CXX", "C", "main.c")]
)
def test_a_language_that_is_enabled_later_is_instrumented(
    tmp_path: Path, first: str, then: str, source: str
) -> None:
    (tmp_path / "p").mkdir()
    (tmp_path / "p/main.c").write_text("int main(void) { return 0; }\n", encoding="utf-8")
    lists = (
        f"cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES {first})\n"
        f"enable_language({then})\nadd_executable(x {source})\nadd_library(s SHARED {source})\n"
    )
    result = build(tmp_path, lists)
    assert (result.analysed(), result.warnings()) == (["s", "x"], [])


@pytest.mark.parametrize("first", ["C", "NONE"])
def test_a_later_language_with_a_compiler_of_its_own_is_named(tmp_path: Path, first: str) -> None:
    lists = (
        f"cmake_minimum_required(VERSION 3.16)\nproject(p LANGUAGES {first})\n"
        "enable_language(CXX)\nadd_executable(x main.cpp)\n"
    )
    compilers = ["-DCMAKE_CXX_COMPILER=g++"] if first == "C" else []
    result = build(tmp_path, lists, toolchain(), *compilers)
    (warning,) = result.warnings()
    assert "enabled after project() or its compile rule was replaced: x; name" in warning
    assert result.analysed() == []


def test_a_project_below_one_without_languages_is_instrumented(tmp_path: Path) -> None:
    (tmp_path / "p/inner").mkdir(parents=True)
    (tmp_path / "p/inner/CMakeLists.txt").write_text(
        "project(inner CXX)\nadd_executable(y ../main.cpp)\n", encoding="utf-8"
    )
    top = "cmake_minimum_required(VERSION 3.16)\nproject(p NONE)\nadd_subdirectory(inner)\n"
    result = build(tmp_path, top)
    assert (result.analysed(), result.warnings()) == (["y"], [])


def test_the_users_own_file_is_included_after_project(tmp_path: Path) -> None:
    own = tmp_path / "own.cmake"
    own.write_text("set(OWN TRUE)\n", encoding="utf-8")
    lists = HEAD + 'if(NOT OWN)\n  message(FATAL_ERROR "no")\nendif()\nadd_executable(x main.cpp)\n'
    for name, disable in (("p", "OFF"), ("q", "ON")):
        arguments = [toolchain(), f"-DCMAKE_PROJECT_INCLUDE={own}", f"-DTPC_DISABLE={disable}"]
        result = build(tmp_path, lists, *arguments, name=name)
        assert result.analysed() == (["x"] if disable == "OFF" else [])


def include() -> str:
    """What the patch puts at the top of a CMakeLists.txt."""
    return f'include("{cmake_file()}" OPTIONAL)\n'


def test_a_build_folder_that_gcc_was_found_for_goes_on_with_clang(tmp_path: Path) -> None:
    targets = (
        "add_library(l STATIC other.cpp)\nadd_executable(x main.cpp)\n"
        "target_link_libraries(x PRIVATE l)\n"
    )
    plain = build(tmp_path, HEAD + targets, "-DCMAKE_BUILD_TYPE=Release")
    assert plain.analysed() == []
    result = build(tmp_path, include() + HEAD + targets, "-DCMAKE_BUILD_TYPE=Release")
    assert (result.analysed(), result.warnings()) == (["x"], [])
    assert result.runs("x").returncode in (0, 1)
    assert build(tmp_path, HEAD + targets).runs("x").returncode in (0, 1)


def test_packages_below_a_toplevel_that_found_gcc_are_instrumented(tmp_path: Path) -> None:
    for name in ("a", "b"):
        folder = tmp_path / "p" / name
        folder.mkdir(parents=True)
        (folder / "package.xml").touch()
        (folder / "main.cpp").write_text(MAIN, encoding="utf-8")
        lists = f"project({name} CXX)\nadd_executable({name}_node main.cpp)\n"
        (folder / "CMakeLists.txt").write_text(include() + lists, encoding="utf-8")
    top = "cmake_minimum_required(VERSION 3.16)\nproject(Project)\n"
    subfolders = "add_subdirectory(a)\nadd_subdirectory(b)\nadd_executable(top main.cpp)\n"
    result = build(tmp_path, top + subfolders, "-DCMAKE_BUILD_TYPE=Release")
    assert result.warnings() == []
    found = [str(path.relative_to(result.folder)) for path in unit_files(result.folder)]
    assert found == ["a/tpc/a_node.json", "b/tpc/b_node.json"]
    assert {unit.package for unit in recorded_units(result.folder) or ()} == {"a", "b"}


def test_a_target_can_be_left_out_and_a_test_is(tmp_path: Path) -> None:
    lists = HEAD + (
        "add_library(gtest STATIC other.cpp)\nadd_executable(quiet main.cpp)\n"
        "set_property(TARGET quiet PROPERTY TPC_INSTRUMENT OFF)\n"
        "add_executable(t main.cpp)\ntarget_link_libraries(t PRIVATE gtest)\n"
        "add_executable(u main.cpp)\ntarget_link_libraries(u PRIVATE gtest)\n"
        "set_property(TARGET u PROPERTY TPC_INSTRUMENT ON)\nadd_executable(x main.cpp)\n"
    )
    result = build(tmp_path, lists, toolchain(), "-DCMAKE_BUILD_TYPE=Release")
    assert result.analysed() == result.manifests() == ["u", "x"]
    reasons = {unit.name: unit.left_out for unit in recorded_units(result.folder) or ()}
    assert reasons == {
        "quiet": "its property TPC_INSTRUMENT is OFF",
        "t": "it is a test (set TPC_TESTS=ON to analyse tests too)",
        "u": "",
        "x": "",
    }
    dynamic = run(["readelf", "-d", result.folder / "quiet"]).stdout
    assert "libtpc_log" not in dynamic
    # It is optimised all the same: nothing of std::string is left to call.
    assert "_ZNSt7__cxx1112basic_string" not in run(["nm", "-C", result.folder / "quiet"]).stdout
    result = build(tmp_path, lists, toolchain(), "-DTPC_TESTS=ON")
    assert result.analysed() == ["t", "u", "x"]


# A workspace may hold ROS itself.
def test_what_carries_reports_makes_none(tmp_path: Path) -> None:
    lists = (
        "cmake_minimum_required(VERSION 3.16)\nproject(roscpp CXX)\n"
        "add_executable(x main.cpp)\nadd_executable(y main.cpp)\n"
        "set_property(TARGET y PROPERTY TPC_INSTRUMENT ON)\n"
    )
    result = build(tmp_path, lists, toolchain(), "-DCMAKE_BUILD_TYPE=Release")
    assert result.analysed() == ["y"]
    reasons = {unit.name: unit.left_out for unit in recorded_units(result.folder) or ()}
    assert reasons == {
        "x": "its code carries the reports (set its property TPC_INSTRUMENT to analyse it too)",
        "y": "",
    }


def test_a_distributions_flags_for_lto_do_not_make_native_objects(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\n"
    result = build(tmp_path, lists, CXXFLAGS="-O2 -flto=auto -ffat-lto-objects")
    assert result.analysed() == ["x"]


def test_a_static_program_is_linked_without_the_log(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\ntarget_link_options(x PRIVATE -static)\n"
    result = build(tmp_path, lists)
    assert (result.analysed(), result.runs("x").returncode) == ([], 0)
    (unit,) = recorded_units(result.folder) or ()
    assert unit.left_out == "it is linked with -static, and reports need a shared library"


def test_a_build_in_the_source_folder_finds_its_own_code(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    build(tmp_path, HEAD + "add_executable(x main.cpp)\n")
    assert run(["cmake", "-S", folder, "-B", folder, toolchain()]).returncode == 0
    commands = run(["cmake", "--build", folder, "-v"]).stdout
    assert f"-tpc-exclude={folder}/devel" in commands
    assert f"-tpc-exclude={folder} " not in commands


def test_a_comma_and_a_space_in_the_path_are_no_separators(tmp_path: Path) -> None:
    result = build(tmp_path / "a, b", HEAD + "add_executable(x main.cpp)\n")
    assert result.analysed() == ["x"]


def test_a_package_that_is_left_alone_keeps_its_compiler(tmp_path: Path) -> None:
    lists = HEAD + (
        "include(CheckCXXCompilerFlag)\ncheck_cxx_compiler_flag(-fno-gcse HAS)\n"
        "if(NOT HAS)\n  message(FATAL_ERROR no)\nendif()\nadd_executable(x main.cpp)\n"
    )
    result = build(tmp_path, lists, toolchain(), f"-DTPC_LEFT_ALONE=/x;{tmp_path}/p")
    assert (result.analysed(), result.warnings()) == ([], [])
    assert recorded_units(result.folder) is None
    cache = (result.folder / "CMakeCache.txt").read_text("utf-8")
    assert "CMAKE_CXX_COMPILER:FILEPATH=/usr/bin/c++" in cache
    assert "TPC_CLANG:" not in cache


def test_a_probe_with_warnings_as_errors_does_not_fail_for_clang(tmp_path: Path) -> None:
    lists = HEAD + (
        'set(CMAKE_CXX_FLAGS "-Wall -Werror -Wno-maybe-uninitialized -Wl,-z,now")\n'
        "include(CheckCXXCompilerFlag)\ncheck_cxx_compiler_flag(-Wshadow HAS)\n"
        "if(NOT HAS)\n  message(FATAL_ERROR no)\nendif()\nadd_executable(x main.cpp)\n"
    )
    assert build(tmp_path, lists).analysed() == ["x"]
    assert build(tmp_path, include() + lists, "-DA=B", name="q").analysed() == ["x"]


@pytest.mark.parametrize("later", [False, True])
def test_assembler_sources_do_not_mind_flags_for_c(tmp_path: Path, later: bool) -> None:
    (tmp_path / "p").mkdir()
    code = "\t.text\n\t.globl one\none:\n\tmovl $1, %eax\n\tret\n"
    code += '\t.section .note.GNU-stack,"",@progbits\n'
    (tmp_path / "p/one.s").write_text(code, encoding="ascii")
    languages = "C CXX)\nenable_language(ASM)\n" if later else "C CXX ASM)\n"
    lists = f"cmake_minimum_required(VERSION 3.16)\nproject(p {languages}" + (
        "add_compile_options(-Werror -O3 -DX)\nadd_executable(x main.cpp one.s)\n"
    )
    assert build(tmp_path, lists).analysed() == ["x"]
    disabled = build(tmp_path, lists, toolchain(), "-DTPC_DISABLE=ON")
    assert disabled.analysed() == []


def test_another_compiler_is_one_warning(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\n"
    result = build(tmp_path, lists, toolchain(), "-DCMAKE_CXX_COMPILER=g++")
    (warning,) = result.warnings()
    assert "the compiler is GNU, not clang" in warning
    assert result.runs("x").returncode in (0, 1)


BITCODE_LIBRARY = "add_library(l STATIC other.cpp)\n"
USER_OF_IT = (
    "add_executable(x user.cpp)\n"
    "target_link_libraries(x ${CMAKE_CURRENT_SOURCE_DIR}/../libl.a)\n"
    "add_executable(y main.cpp)\n"
)
READER = "#include <string>\nstd::string other(int);\nint main() { return other(3).size() != 3; }\n"


@pytest.mark.parametrize("how", ["left alone", "another compiler"])
def test_what_gcc_builds_links_the_bitcode_of_others(tmp_path: Path, how: str) -> None:
    library = build(tmp_path, HEAD + BITCODE_LIBRARY, name="q").folder / "libl.a"
    (tmp_path / "p").mkdir()
    shutil.copy(library, tmp_path)
    (tmp_path / "p/user.cpp").write_text(READER, encoding="utf-8")
    alone = f"-DTPC_LEFT_ALONE={tmp_path}/p"
    option = alone if how == "left alone" else "-DCMAKE_CXX_COMPILER=g++"
    result = build(tmp_path, HEAD + USER_OF_IT, toolchain(), option)
    assert result.analysed() == []
    assert result.runs("x").returncode == 0


def test_flags_that_only_gcc_knows_are_not_taken_where_clang_replaces_it(tmp_path: Path) -> None:
    lists = HEAD + (
        "include(CheckCXXCompilerFlag)\ncheck_cxx_compiler_flag(-fno-gnu-unique HAS)\n"
        "if(HAS)\n  add_compile_options(-fno-gnu-unique)\nendif()\n"
        "if(CMAKE_COMPILER_IS_GNUCXX)\n  add_compile_options(-fconcepts)\nendif()\n"
        "add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)\n"
        "add_executable(x main.cpp)\n"
    )
    result = build(tmp_path, lists, f"-DCMAKE_PROJECT_INCLUDE={cmake_file()}")
    assert (result.analysed(), result.warnings()) == (["x"], [])


def test_a_compiler_that_is_named_after_project_changes_nothing(tmp_path: Path) -> None:
    lists = HEAD + "set(CMAKE_CXX_COMPILER g++)\nadd_executable(x main.cpp)\n"
    assert build(tmp_path, lists).analysed() == ["x"]


def test_the_archives_of_gccs_own_lto_stay_gccs(tmp_path: Path) -> None:
    lists = (
        "cmake_minimum_required(VERSION 3.16)\nset(CMAKE_CXX_COMPILER g++)\nproject(p CXX)\n"
        "set(CMAKE_INTERPROCEDURAL_OPTIMIZATION ON)\nadd_library(l STATIC other.cpp)\n"
        "add_executable(x user.cpp)\ntarget_link_libraries(x l)\n"
    )
    (tmp_path / "p").mkdir()
    (tmp_path / "p/user.cpp").write_text(READER, encoding="utf-8")
    assert build(tmp_path, lists).runs("x").returncode == 0


PARALLEL = """#include <omp.h>
int main() {
  int sum = 0;
#pragma omp parallel for reduction(+ : sum)
  for (int i = 0; i < 100; ++i)
    sum += i;
  return sum != 4950 || omp_get_max_threads() < 1;
}
"""


@pytest.mark.parametrize("way", ["toolchain", "patched", "below"])
def test_openmp_works_whether_clang_has_it_or_not(tmp_path: Path, way: str) -> None:
    targets = (
        "find_package(OpenMP REQUIRED)\nadd_executable(x par.cpp)\n"
        "target_link_libraries(x OpenMP::OpenMP_CXX)\n"
    )
    package = tmp_path / "p" / ("below" if way == "below" else "")
    package.mkdir(parents=True)
    (package / "par.cpp").write_text(PARALLEL, encoding="utf-8")
    if way == "below":
        (package / "package.xml").touch()
        (package / "CMakeLists.txt").write_text(include() + "project(b)\n" + targets, "utf-8")
        lists = HEAD + "add_subdirectory(below)\n"
    else:
        lists = (include() if way == "patched" else "") + HEAD + targets
    arguments = () if way == "toolchain" else ("-DCMAKE_BUILD_TYPE=Release",)
    result = build(tmp_path, lists, *arguments)
    assert result.runs("below/x" if way == "below" else "x").returncode == 0
    (tmp_path / "one.c").write_text("int main(void) { return 0; }\n", encoding="ascii")
    has_it = run(["clang-19", "-fopenmp", tmp_path / "one.c", "-o", tmp_path / "one"])
    if has_it.returncode != 0:
        (warning,) = result.warnings()
        assert f"TPC: {'below' if way == 'below' else 'p'} is built without" in warning
        assert "apt-get install libomp-19-dev" in warning


def test_several_configurations_in_one_folder(tmp_path: Path) -> None:
    lists = HEAD + "add_executable(x main.cpp)\nadd_library(s SHARED other.cpp)\n"
    result = build(tmp_path, lists, toolchain(), "-G", "Ninja Multi-Config")
    assert result.analysed() == ["s", "x"]
    units = {unit.name: unit.artifact for unit in recorded_units(result.folder) or ()}
    assert units["x"] == result.folder / "Debug/x"
    assert run(["cmake", "--build", result.folder, "--config", "Release"]).returncode == 0
    assert result.runs("Release/x").returncode in (0, 1)


@pytest.mark.parametrize("generator", ["Ninja", "Unix Makefiles"])
def test_a_build_folder_goes_on_when_it_is_patched_and_restored(
    tmp_path: Path, generator: str
) -> None:
    lists = HEAD + (
        "add_library(l STATIC other.cpp)\nadd_executable(x user.cpp)\n"
        "target_link_libraries(x PRIVATE l)\n"
    )
    (tmp_path / "p").mkdir()
    (tmp_path / "p/user.cpp").write_text(READER, encoding="utf-8")
    folder = build(tmp_path, lists, "-G", generator).folder
    for text, analysed in ((include() + lists, True), (lists, False)):
        # The sources stay as they are, times and all.
        (tmp_path / "p/CMakeLists.txt").write_text(text, encoding="utf-8")
        made = run(["cmake", "--build", folder])
        assert made.returncode == 0, made.stdout + made.stderr
        (one,) = folder.rglob("other.cpp.o")
        assert (one.read_bytes()[:4] != b"\x7fELF") is analysed
        assert run([folder / "x"]).returncode == 0
        assert not analysed or (folder / "tpc/x.json").is_file()
