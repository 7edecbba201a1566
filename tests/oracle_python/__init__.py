"""An independent check of the analysis of Python: what runs show against what it says."""
