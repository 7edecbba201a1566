"""A made-up fleet: missions of robots with known errors, to test and measure ``pytpc fleet``."""
