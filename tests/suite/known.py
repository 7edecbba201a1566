"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

KNOWN = {
    "exp_message_vector_dropped": "what is put into a vector that is only counted",
    "thr_globals": "elements of an array are one variable",
}
