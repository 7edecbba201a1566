"""Static information for tests: literal JSON objects (docs/reference/formats.md)."""

from typing import Any

KEYS = [
    "6f1c0f4e-7a1b-5c3d-8e2f-000000000001",
    "6f1c0f4e-7a1b-5c3d-8e2f-000000000002",
    "6f1c0f4e-7a1b-5c3d-8e2f-000000000003",
]


def step(kind: str, lineno: int, what: str, **changes: Any) -> dict[str, Any]:
    """A step of a way on a line of src/detector.cpp."""
    return {
        "step": kind,
        "file": "src/detector.cpp",
        "lineno": lineno,
        "column": 6,
        "function": "face::Detector::onImage",
        "what": what,
        "source_code": f"line {lineno};",
        **changes,
    }


def spot(kind: str, parameter: str | None, lineno: int, what: str) -> dict[str, Any]:
    """A blind spot on a line of src/detector.cpp."""
    place = step("", lineno, what)
    del place["step"]
    return {"kind": kind, "parameter": parameter, **place}


def not_exposed(source: str, lineno: int) -> dict[str, Any]:
    """A comparison on a line of src/detector.cpp on which nothing exposed depends."""
    place = step("", lineno, "")
    del place["step"], place["what"]
    return {"source": source, **place}


def comparison(**changes: Any) -> dict[str, Any]:
    """``if (coverage > min_coverage_limit_)`` on line 40 of src/detector.cpp, with changes."""
    return {
        "key": KEYS[0],
        "type": "parameter",
        "name": "min_coverage_limit_",
        "source": "min_coverage_limit",
        "file": "src/detector.cpp",
        "lineno": 40,
        "column": 16,
        "function": "face::Detector::onImage(int)",
        "distance": 1,
        "relation": ">",
        "topic": "capture",
        "source_code": "if (coverage > min_coverage_limit_)",
        "other_thresholds": 0,
        "param_reads": [{"file": "src/detector.cpp", "lineno": 12}],
        "publishes": [{"file": "src/detector.cpp", "lineno": 41}],
        "transform": None,
        "default": 0.25,
        "read_at": {"file": "src/detector.cpp", "lineno": 12},
        "exposed_at": {"file": "src/detector.cpp", "lineno": 41},
        "path": [
            step("read", 12, "min_coverage_limit read into Detector::min_coverage_limit_"),
            step("compare", 40, "compared: coverage > min_coverage_limit_; guards publish()"),
            step("expose", 41, "published on capture"),
        ],
        **changes,
    }


def counts(**changes: int) -> dict[str, int]:
    return {
        "functions": 7,
        "predicates": 9,
        "predicates_in_slice": 5,
        "parameter_reads": 1,
        "exposing_statements": 1,
        "comparisons": 1,
        "dynamic_names": 0,
        "indirect_calls": 2,
        "without_debug_info": 0,
        "outside_sources": 3,
        "lost_values": 0,
        "not_instrumented": 0,
        "not_exposed": 0,
        "blind_spots": 0,
        "constants": 0,
        "given_up": 0,
        **changes,
    }


def unit(**changes: Any) -> dict[str, Any]:
    """The node ``detector`` of package ``face`` with one comparison, with changes."""
    return {
        "schema": 1,
        "link_unit": "detector",
        "package": "face",
        "source_root": "/ws/src/face",
        "tool": {"name": "tpc", "version": "0.1.0", "llvm": "19.1.7", "profile": "default"},
        "status": "ok",
        "failure": None,
        "counts": counts(),
        "parameters": [
            {
                "name": "min_coverage_limit",
                "api": "ros::NodeHandle::param",
                "type": "double",
                "default": 0.25,
                "file": "src/detector.cpp",
                "lineno": 12,
                "column": 6,
                "function": "face::Detector::Detector()",
            }
        ],
        "exposing": [
            {
                "api": "ros::Publisher::publish",
                "topic": "capture",
                "file": "src/detector.cpp",
                "lineno": 41,
                "column": 5,
                "function": "face::Detector::onImage(int)",
            }
        ],
        "comparisons": [comparison()],
        "not_exposed": [],
        "blind_spots": [],
        **changes,
    }


def failed_unit(**changes: Any) -> dict[str, Any]:
    """A unit that the instrumentation had to leave as it was."""
    return unit(
        **{
            "link_unit": "broken",
            "status": "failed",
            "failure": "the instrumented module does not verify",
            "counts": counts(comparisons=0, parameter_reads=0, exposing_statements=0),
            "parameters": [],
            "exposing": [],
            "comparisons": [],
            **changes,
        }
    )
