"""Which objects a value may be, and so what a call calls."""
