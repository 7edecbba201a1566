"""Which declaration (type, range, step) is about the parameter of a suspect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pytpc.diagnosis.results.suspects import Accused, Suspect
from pytpc.recording.declaration import Declared
from pytpc.static.parameters import same_parameter

if TYPE_CHECKING:
    from pathlib import PurePath


def declared_for(
    declared: Sequence[Declared], suspect: Suspect | Accused, source: PurePath | None = None
) -> Declared | None:
    """What is declared of a suspect's parameter; None without a declaration, or if they differ.

    What the node itself published counts before what a file says. With ``source``, the file of the
    comparison, only declarations of the package that holds this file count.
    """
    same = [one for one in declared if same_parameter(one.parameter, suspect.parameter)]
    said = [one for one in same if one.parameter.startswith(f"{suspect.last.node}/")]
    if not said:
        # Full names are those of messages: other nodes have parameters of their own.
        said = [one for one in same if not one.parameter.startswith("/")]
        if source is not None:
            above = {str(folder) for folder in source.parents}
            said = [one for one in said if one.package in above]
    meanings = {replace(one, parameter="", description="", place="", package="") for one in said}
    return said[0] if len(meanings) == 1 else None
