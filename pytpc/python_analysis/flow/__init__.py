"""Where values go to and come from."""
