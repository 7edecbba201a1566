"""The nodes of the suite that the analysis does not get right, and why (analysis-limits.md)."""

KNOWN = {
    "exp_timer_start_stop": "what starts a timer is taken to decide what is published",
    "val_virtual_cut": "which of two observers is made is taken to decide what is published",
}
