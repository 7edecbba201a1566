"""An independent check of the passes: SPEC 3 a second time, slow and simple, on random programs."""
