"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""


KNOWN = {
    "ctl_exception_callee": "exceptions make no dependence (SPEC 3), a reader says that they do",
    "ctl_exception_swallowed": "both ends of a throw that is caught at once lead to one publish",
}
