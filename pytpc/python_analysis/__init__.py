"""Python nodes: from the source of a script and its modules to static information (SPEC 10)."""
