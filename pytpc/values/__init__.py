"""Where the values of parameters come from, and how they are changed."""
