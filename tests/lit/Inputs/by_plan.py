"""by_plan.py OUT -- LINK WORD...: links with an analysis, then by the plan of that, and compares.

The program and the static information must be the same, byte for byte, beside the field
``processes``. Prints what was compared: a line for each comparison, and counts.
"""

import json
import re
import subprocess
import sys

out, dashes, *link = sys.argv[1:]
assert dashes == "--"


def linked(name: str, *options: str) -> None:
    words = [f"-tpc-static-info={out}.{name}.json", *options]
    words += [
        "-tpc-link-unit=unit",
        "-tpc-package=pack",
        "-tpc-source-root=/nowhere",
        "-tpc-constants",
    ]
    given = [word for option in words for word in ("-Xlinker", "-mllvm", "-Xlinker", option)]
    done = subprocess.run(
        [*link, *given, "-o", f"{out}.{name}"], capture_output=True, text=True, check=False
    )
    sys.stderr.write(done.stdout + done.stderr)
    if done.returncode or done.stderr:
        sys.exit(f"the link {name} failed or warned")


linked("analysed", f"-tpc-plan-out={out}.plan")
linked("planned", f"-tpc-plan={out}.plan")

with open(f"{out}.analysed", "rb") as first, open(f"{out}.planned", "rb") as second:
    if first.read() != second.read():
        sys.exit("the programs differ")
with open(f"{out}.planned.json", encoding="utf-8") as file:
    planned, found = re.subn(r'\n *"processes": \[\n *"unit"\n *\],', "", file.read())
with open(f"{out}.analysed.json", encoding="utf-8") as file:
    analysed = file.read()
# Of the unit, and of each comparison.
comparisons = json.loads(analysed)["comparisons"]
assert found == len(comparisons) + 1
if planned != analysed:
    with open(f"{out}.without.json", "w", encoding="utf-8") as file:
        file.write(planned)
    sys.exit(f"the static information differs: diff {out}.analysed.json {out}.without.json")

with open(f"{out}.plan", encoding="utf-8") as file:
    plan = json.load(file)
for comparison in comparisons:
    print(comparison["type"], comparison["source"], comparison["relation"])
reports = plan["reports"]
print("reports", len(reports))
print("held", sum("held" in report for report in reports))
print("switches", sum(report["switch"] for report in reports))
print("objects", sum("object" in report for report in reports))
print("names", len(plan["names"]))
print("rounds", len(plan["rounds"]))
print("copies", sum("of" in function for function in plan["functions"]))
