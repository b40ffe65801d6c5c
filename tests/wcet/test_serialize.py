"""The JSON document follows its published schema, for results with and without a bound."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from mauve.records import changed
from mauve.wcet.result import ProblemKind
from mauve.wcet.serialize import SCHEMA, document, function
from tests.wcet.test_cache import BOARD, FAILED, FULL

PATH = Path(__file__).parents[2] / "docs" / "schema" / "wcet-1.schema.json"


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(PATH.read_text(encoding="utf-8"))
    return loaded


def test_documents_follow_the_schema(schema: dict[str, Any]) -> None:
    jsonschema.Draft202012Validator.check_schema(schema)
    made = json.loads(json.dumps(document("robot.elf", BOARD, (FULL, FAILED))))
    jsonschema.validate(made, schema)
    assert made["schema"] == schema["title"] == SCHEMA


def test_nanoseconds_are_rounded_up() -> None:
    assert function(FULL)["wcet_ns"] == 5 * 10**15

    assert function(changed(FULL, time=1001))["wcet_ns"] == 2
    assert function(FAILED)["wcet_ns"] is None


def test_every_kind_of_problem_is_in_the_schema(schema: dict[str, Any]) -> None:
    assert set(schema["$defs"]["problem"]["properties"]["kind"]["enum"]) == {kind.value for kind in ProblemKind}
