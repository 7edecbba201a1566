"""How the tests of the passes are run: one behaviour a file, by lit and FileCheck."""

import os

import lit.formats

config.name = "tpc"
config.test_format = lit.formats.ShTest(execute_external=False)
config.suffixes = [".cpp", ".ll", ".test"]
config.excludes = ["Inputs"]
config.test_source_root = os.path.dirname(__file__)
config.test_exec_root = config.tpc_obj_root

inputs = os.path.join(config.test_source_root, "Inputs")
plugin = config.tpc_plugin
clangxx = os.path.join(config.tpc_tools, "clang++")
opt = os.path.join(config.tpc_tools, "opt")
lld = os.path.join(config.tpc_tools, "ld.lld")
load = f"-load={plugin} -load-pass-plugin={plugin}"

clang = os.path.join(config.tpc_tools, "clang")
flags = f"-g -flto=full -fpass-plugin={config.tpc_defer} -grecord-command-line"
# The rest of a command.
rest = "[^&|;]*"


def after(command, headers):
    """The same compiler after most headers; without them where nobody has built check-lit yet."""
    found = os.path.join(config.tpc_obj_root, "headers", f"{headers}.pch")
    return f"{command} -include-pch {found}" if os.path.exists(found) else command


def with_headers(name, command, levels):
    """``after`` the headers (CMakeLists.txt), for commands whose options allow it."""
    for level, option in levels.items():
        fits = f"{name}(?!{rest} -(?:std|fsanitize)=)(?={rest}{option})"
        yield f"{fits}(?={rest} -fPIC)", after(command, f"{level}-pic")
        yield fits, after(command, level)
    yield name, command


compile_ = f"{clangxx} -std=c++17 {flags} -isystem {inputs}/include -c"
native = f"{clangxx} -std=c++17 -O1 -isystem {inputs}/include"

# Longer names come first: lit replaces a name wherever it begins.
config.substitutions += [
    # The same as the next but one, with the real headers of ROS.
    ("%compile-real", after(f"{clangxx} -std=c++17 {flags} -c", "ros")),
    # The same for C; ROS has no headers for C.
    ("%compile-c", f"{clang} {flags} -c"),
    # The compiler as tpc.cmake sets it up; each test adds the level.
    *with_headers("%compile", compile_, {level: f" -{level}" for level in ("O0", "O1", "O2")}),
    *with_headers("%native", native, {"O1": ""}),
    # The linker with the plugin; further options as `-mllvm -tpc-...`.
    (
        "%link",
        f"{clangxx} -flto=full --ld-path={lld} -Wl,--load-pass-plugin={plugin}"
        f" -Wl,-mllvm,-load={plugin} -Wl,-mllvm,-tpc-exclude={inputs}/include",
    ),
    ("%opt", f"{opt} {load} -tpc-exclude={inputs}/include"),
    # The compilers for builds that are not CMake: %tpc-clang and %tpc-clang++.
    ("%tpc-clang", os.path.join(config.tpc_bin, "tpc-clang")),
    # Makes one module of the link units of a process.
    ("%merge", os.path.join(config.tpc_bin, "tpc-merge")),
    ("%relink", os.path.join(config.tpc_bin, "tpc-relink")),
    ("%tpc-ar", os.path.join(config.tpc_bin, "tpc-ar")),
    ("%inputs", inputs),
    ("%python", config.tpc_python),
    ("%log-library", config.tpc_log),
    ("%{log-folder}", os.path.dirname(config.tpc_log)),
]
config.environment["PATH"] = os.pathsep.join(
    [config.tpc_tools, "/usr/bin", "/bin"]
)
if os.path.exists("/usr/include/dynamic_reconfigure/server.h") and os.path.exists(
    "/usr/share/dynamic_reconfigure/templates/ConfigType.h.template"
):
    config.available_features.add("dynamic-reconfigure")
if all(
    os.path.exists(f"/usr/include/{header}")
    for header in ("actionlib/TestAction.h", "tf/transform_broadcaster.h", "std_srvs/Empty.h")
):
    config.available_features.add("ros1-headers")
