"""The values that the variants of suggestions ask for (`pytpc_evaluation.study.suggestions`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.base.wording import percent
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.results.advice import Remedy
from pytpc.diagnosis.suggestion.advise import advise_blamed
from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.recording.mission import Recording, load_recording
from pytpc.static.parameters import DYNAMIC, same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.study.data import load_mission
from pytpc_evaluation.study.fix_chains import next_fix
from pytpc_evaluation.study.methods.ours import tpc_reference
from pytpc_evaluation.study.suggestion_chains import (
    FIX_RUNS,
    RANKED,
    RANKED_REFERENCE,
    SUSPECTS,
    VARIANTS,
    Chain,
    Try,
)


def next_try(chain: Chain, out: Path) -> Try:
    """The next value of a chain that is not over and has none that is to be flown.

    Raises:
        InputError: a file of the study is missing or broken.
    """
    if chain.variant in FIX_RUNS:
        return next_fix(chain, out)
    if chain.variant in {RANKED, RANKED_REFERENCE}:
        return _ranked(chain, out)
    mission = out / "missions" / chain.mission
    treatment = parse_json(mission / "treatment.json")
    if not isinstance(treatment, dict) or not isinstance(treatment.get("parameter"), str):
        raise InputError("not a treatment with a parameter", mission / "treatment.json")
    parameter, node = treatment["parameter"], treatment.get("node")
    folder, flown = mission, []
    if chain.variant == SUSPECTS:
        if len(chain.tries) >= len(chain.order):
            return Try("", None, None, None, reason="no more suspects")
        parameter, node = chain.order[len(chain.tries)], None
    elif chain.tries:
        folder = out / chain.flown()
        flown = [chain.new, *(one.value for one in chain.tries[:-1] if one.value is not None)]
    if DYNAMIC in parameter:
        return Try(parameter, node, None, None, reason="only the running node knows its name")
    recording = load_recording(folder)
    if not recording.marks:
        return Try(parameter, node, None, None, reason="nobody set a mark")
    found = _asked(chain, out, recording, parameter, flown)
    if node is None or not same_parameter(parameter, treatment["parameter"]):
        node = _node(recording, found.key)
    if VARIANTS[chain.variant] is None:
        smallest = None if found.smallest is None else found.smallest.value
        found = replace(found, value=smallest, basis="smallest")
    return _try(parameter, node, found)


def _ranked(chain: Chain, out: Path) -> Try:
    """What a user has who knows a good run and nothing of the treatment.

    It is the first of the ranking `tpc_reference` by the marks as they were said, with the value
    that `pytpc suggest` and `pytpc rank` lead with for it.
    """
    mission = load_mission(out, out / "missions" / chain.mission, chain.half)
    case = mission.case("confused")
    if not case.recording.marks:
        return Try("", None, None, None, reason="nobody set a mark")
    order = tpc_reference(case).order
    found = blame(case.recording, case.static_info, Question(references=case.references))
    if not order or not found.suspects:
        return Try("", None, None, None, reason="nobody is suspected")
    if found.none > found.confidence:
        words = f"none of the parameters comes first: {percent(found.none)}"
        return Try("", None, None, None, reason=f"{words}, {order[0]} {percent(found.confidence)}")
    sources = VARIANTS[chain.variant] or frozenset()
    references = case.references if "reference" in sources else ()
    question = Question(top=1, sources=sources, references=references)
    (advice,) = advise_blamed(found.only(order[0]), case.recording, case.static_info, question)
    return _try(order[0], _node(case.recording, advice.accused.key), advice.remedy)


def _try(parameter: str, node: str | None, found: Remedy) -> Try:
    if found.value is None:
        return Try(parameter, node, None, None, reason=found.reason or "nothing is suggested")
    return Try(parameter, node, float(found.value), found.basis)


def _asked(
    chain: Chain, out: Path, recording: Recording, parameter: str, flown: Sequence[float]
) -> Remedy:
    static = StaticInfo.load(out / "systems" / chain.system / "static.json")
    sources = VARIANTS[chain.variant] or frozenset()
    beside = "reference" in sources
    references = (load_recording(out / "reference" / chain.system),) if beside else ()
    question = Question(sources=sources, references=references, flown=flown)
    return remedy(recording, static, parameter, recording.marks, question)


def _node(recording: Recording, key: str | None) -> str | None:
    """The node that evaluated a comparison; None where several did, or none."""
    events = recording.events
    if key is None or key not in events.keys:
        return None
    codes = set(events.node[events.by_key.rows(events.keys.index(key))].tolist())
    return events.nodes[codes.pop()] if len(codes) == 1 else None
