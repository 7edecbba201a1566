"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""


KNOWN = {
    "ctl_exception_callee": "exceptions make no dependence (SPEC 3), a reader says that they do",
    "ctl_exception_swallowed": "both ends of a throw that is caught at once lead to one publish",
    "exp_message_vector_dropped": "what is put into a vector that is only counted",
    "thr_globals": "elements of an array are one variable",
}
