"""The commands that the evaluation adds to ``pytpc``, by the entry point ``pytpc.commands``."""

_HERE = __name__

SUMMARIES = {
    "stats": (f"{_HERE}.stats_commands", "Tables and figures of a study from recorded missions."),
    "study": (
        f"{_HERE}.study_commands",
        "Fly the study of the example robots, and write its page.",
    ),
    "survey": (
        f"{_HERE}.survey_commands",
        "Build source trees with and without TPC, and compare them.",
    ),
}
