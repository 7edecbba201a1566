"""Pages for people: ``html`` has the suspects of missions, ``catalogue`` the TPCs."""
