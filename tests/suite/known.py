"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

BOUND = "what bind and std::function keep is told apart by its type alone"
SWAPPED = "both operands come from parameters, and one is taken for the other"
CONSTANT = "a constant that comes through a variable or a function"
NOT_JUDGED = "not looked into yet"

KNOWN = {
    "cmp_bool": NOT_JUDGED,
    "const_named": CONSTANT,
    "ctl_exception_callee": "exceptions make no dependence (SPEC 3), a reader says that they do",
    "ctl_exception_swallowed": "both ends of a throw that is caught at once lead to one publish",
    "exp_message_vector_dropped": "what is put into a vector that is only counted",
    "exp_three_calls": "the distance is 3, a reader says 4",
    "exp_timer_start_stop": "the timer and the message share a library's class",
    "read_config_struct": "fields that are returned in one register",
    "read_get_param": NOT_JUDGED,
    "read_reconfigure_fields": SWAPPED,
    "read_search_param": "the handle's namespace stands before a name that was sought",
    "thr_boost_bind": BOUND,
    "thr_globals": "elements of an array are one variable",
    "val_bind": BOUND,
    "val_bind_unused": BOUND,
    "val_lambda": NOT_JUDGED,
    "val_message_field": SWAPPED,
    "val_min_max_clamp": NOT_JUDGED,
    "val_std_function": BOUND,
}
