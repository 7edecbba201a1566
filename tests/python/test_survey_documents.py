"""The survey's tables as text."""

import csv
import io

from survey_samples import AFTER, BAD, build, found, result

from pytpc_evaluation.survey.static_tables import tables
from pytpc_evaluation.survey.survey_documents import documents, faults
from pytpc_evaluation.tables import as_csv, as_latex, as_markdown, latex


def test_csv_has_numbers_in_full() -> None:
    results = [
        result("arm", 10.0, 15.0, found=found(4, python=2)),
        result("leg", 30.0, 33.0, found=found(1)),
    ]
    rows = list(csv.reader(io.StringIO(as_csv(tables(results)[0]))))
    assert rows[0][:7] == ["name", "time", "time factor", "tpcs", "c++", "python", "unique"]
    assert rows[1] == ["arm", "10", "1.5", "6", "4", "2", "2", "2", "3", "0"]
    assert rows[2] == ["leg", "30", "1.1", "1", "1", "0", "1", "1", "3", "0"]
    assert [row[0] for row in rows[3:]] == ["mean", "median", "std", "min", "max", "sum"]
    assert rows[8][:4] == ["sum", "40", "1.2", "7"]


def test_of_one_number_there_is_no_deviation() -> None:
    rows = list(csv.reader(io.StringIO(as_csv(tables([result("arm", 10.0, 15.0)])[0]))))
    assert (rows[4][0], rows[4][3]) == ("std", "")


def test_no_two_columns_of_a_csv_have_one_name() -> None:
    every = tables([result("arm", 1.0, 1.0)])
    assert every
    for table in every:
        heading = as_csv(table).splitlines()[0].split(",")
        assert len(heading) == len(set(heading))


def test_markdown() -> None:
    lines = as_markdown(tables([result("a|b_c", 10.0, 12.5)])[0]).splitlines()
    assert lines[0].startswith("| Name | Time | Time Factor | TPCs | C++ |")
    assert lines[1].startswith("| --- | --: |")
    assert lines[2].startswith(r"| a\|b\_c | 10.0 | 1.25 | 0 | 0 | 0 | 0 |")
    assert lines[3].startswith("| *mean* | 10.0 | 1.25 | 0 | 0 | 0 |")


def test_a_mean_of_counts_has_a_decimal_place() -> None:
    results = [result("a", 1.0, 1.0, found=found(1)), result("b", 1.0, 1.0, found=found(2))]
    mean = as_markdown(tables(results)[0]).splitlines()[4]
    assert mean.startswith("| *mean* | 1.0 | 1.00 | 1.5 | 1.5 | 0 | 1 | 1 | 3 | 0 |")


def test_latex() -> None:
    text = as_latex(tables([result("nav_core & 50%", 10.0, 12.5)])[0])
    assert "\n\\begin{longtable}{lrrrrrrrrr}\n\\caption{Comparisons with parameters}" in text
    heading = r"Name & Time & \shortstack[r]{Time\\Factor} & TPCs & C++ & Python & Unique & Files"
    # On the first page and on those that follow.
    assert text.count(heading) == 2
    assert r"nav\_core \& 50\% & 10.0 & 1.25 & 0 & 0" in text
    for rule in (r"\toprule", r"\midrule", r"\bottomrule", r"\endfirsthead", r"\endlastfoot"):
        assert rule in text
    assert text.endswith("\\end{longtable}\n}\n")


def test_latex_prints_its_own_characters() -> None:
    assert latex(r"\a{b}_c^d~e#f$g<h") == (
        r"\textbackslash{}a\{b\}\_c\textasciicircum{}d\textasciitilde{}e\#f\$g\textless{}h"
    )


def test_faults_of_tpc_come_first() -> None:
    results = [
        result("arm", build(1.0, BAD, AFTER), build(1.0, BAD, AFTER)),
        result(
            "leg",
            1.0,
            build(1.0, BAD),
            found=found(failed=("leg/n: too large",), without=("leg/m",)),
        ),
        result("gcc", build(1.0, BAD), 1.0),
        result("fast", None, 1.0),
        result("none", 1.0, build(1.0, BAD), packages=1),
    ]
    assert faults(results) == [
        ("leg", "not built with TPC", "bad", BAD.reason),
        ("none", "not built with TPC", "bad", BAD.reason),
        ("arm", "not built", "bad", f"{BAD.reason} (missing: Eigen3)"),
        ("arm", "not built", "after", AFTER.reason),
        ("arm", "partial", "", "figures of 1 of 3 packages"),
        ("leg", "not analysed", "leg/n", "too large"),
        ("leg", "not analysed", "leg/m", "linked without the analysis"),
        ("leg", "no factor", "", "the two builds did not build the same packages"),
        ("gcc", "built only with TPC", "bad", f"{BAD.reason} (missing: Eigen3)"),
        ("gcc", "no factor", "", "the two builds did not build the same packages"),
        ("fast", "no factor", "", "no plain build was asked for"),
        ("none", "no factor", "", "no package was built"),
    ]


def test_without_a_plain_build_what_fails_is_still_said() -> None:
    assert faults([result("arm", None, build(1.0, AFTER))])[0] == (
        "arm",
        "not built",
        "after",
        AFTER.reason,
    )


def test_documents() -> None:
    results = [result("arm", build(1.0, BAD), build(1.0, BAD))]
    written = documents(results, ("csv", "markdown", "latex"))
    assert sorted(written) == [
        "comparisons.csv",
        "faults.csv",
        "lines.csv",
        "survey.md",
        "survey.tex",
        "times.csv",
    ]
    assert "| arm | not built | bad | CMake: CMakeLists.txt:3" in written["survey.md"]
    assert sorted(documents(results, ("latex",))) == ["survey.tex"]
