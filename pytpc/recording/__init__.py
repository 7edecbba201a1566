"""The data model of a mission: events, summaries, marks, declarations of parameters."""
