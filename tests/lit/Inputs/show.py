"""Static information in lines that a test can match: `show.py paths|spots|not-exposed|messages FILE`."""

import json
import sys

what, path = sys.argv[1:]
with open(path, encoding="utf-8") as file:
    unit = json.load(file)
if what == "paths":
    for found in (c for c in unit["comparisons"] if "path" in c):
        print(f"{found['source']}: {len(found['path'])} steps")
        for number, step in enumerate(found["path"], start=1):
            place = f"{step['lineno']} {step['function']}"
            print(f"{found['source']} {number}: {step['step']} {place}: {step['what']}")
elif what == "messages":
    for found in unit["comparisons"]:
        line = f"{found['source']}: {found['topic']} {found.get('message')}"
        for one in found.get("received", ()):
            line += f" <- {one['topic']} {one['type']} {one['by']}"
        print(line)
elif what == "spots":
    print(f"{unit['counts']['blind_spots']} blind spots, {len(unit['blind_spots'])} listed")
    for spot in unit["blind_spots"]:
        place = f"{spot['parameter']} {spot['lineno']} {spot['function']}"
        print(f"{spot['kind']} {place}: {spot['what']}")
else:
    print(f"{unit['counts']['not_exposed']} not exposed")
    for found in unit["not_exposed"]:
        print(f"{found['source']} {found['lineno']} {found['function']}: {found['source_code']}")
