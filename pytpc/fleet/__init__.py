"""The data set of a fleet's missions: its tables, and how they are kept on disk or in a store."""
