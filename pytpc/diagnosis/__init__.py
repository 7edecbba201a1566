"""From a recording to the parameter: scores, ranking, suggestion. No files, no graph."""
