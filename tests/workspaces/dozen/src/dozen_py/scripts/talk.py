#!/usr/bin/env python3
"""Does nothing: there has to be a script to install."""
