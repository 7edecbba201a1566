"""What `lint --json` prints fits the schema, and the schema knows all kinds."""

from __future__ import annotations

import json

from jsonschema import Draft202012Validator
from lint_samples import facts, node, read

from pytpc.base.paths import project_root
from pytpc.lint.check import check
from pytpc.lint.finding import KINDS
from pytpc.present.findings import findings_as_json

SCHEMA = json.loads((project_root() / "pytpc/base/schema/answers.schema.json").read_text())
ANSWER = SCHEMA["$defs"]["lint"]
OF_FINDING = ANSWER["properties"]["findings"]["items"]["properties"]


def test_the_answer_fits_the_schema():
    stock = node(name="/driver", unjudged="driver/driver was not analysed")
    values: dict[str, object] = {"/robot/guard/min_distnace": 0.4, "/driver/rate": 5}
    checked = check(facts(values, node(read("/robot/guard/min_distance", 0.5)), stock))
    answer = {"files": ["robot.launch"], "unread": {}, **findings_as_json(checked)}
    assert [one["kind"] for one in answer["findings"]] == ["unread"]
    assert answer["unjudged"] == {"driver/driver was not analysed": ["/driver/rate"]}
    Draft202012Validator({**SCHEMA, "$ref": "#/$defs/lint"}).validate(answer)


def test_the_schema_knows_all_kinds():
    assert OF_FINDING["kind"]["enum"] == list(KINDS)
