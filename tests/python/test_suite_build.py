"""The suite's programs are linked without the passes by the same command less what loads them."""

import shlex

from suite.build import without_passes


def test_leaves_out_the_plugin_and_its_options_alone() -> None:
    command = shlex.split(
        "clang++ -O2 -Xlinker --load-pass-plugin=/p.so -Xlinker -mllvm -Xlinker -load=/p.so"
        " -Xlinker -rpath -Xlinker /lib -Xlinker -mllvm -Xlinker -tpc-link-unit=a -flto=full"
        " -Xlinker -mllvm -Xlinker -other a.o -o a"
    )
    assert without_passes(command) == shlex.split(
        "clang++ -O2 -Xlinker -rpath -Xlinker /lib -flto=full"
        " -Xlinker -mllvm -Xlinker -other a.o -o a"
    )
