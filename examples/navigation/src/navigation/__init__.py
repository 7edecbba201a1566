"""The mission of the ground robot: what it does, from its dock to the goal and back."""
