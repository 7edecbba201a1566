"""Functions as blocks of instructions, and which branches control them."""
