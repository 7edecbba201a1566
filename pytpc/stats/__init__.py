"""The tables and figures of SPEC 9 from recorded missions."""
