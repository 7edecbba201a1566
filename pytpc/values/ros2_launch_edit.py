"""Changes one value in a launch file of ROS 2 (Python, XML, YAML); all other bytes stay."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from pytpc.values.launch_edit import NewText
from pytpc.values.launch_xml import Attribute, Tag, encoding_of, read_tags, written
from pytpc.values.new_value import Refused, yaml_text
from pytpc.values.origins import Origin
from pytpc.values.rcl_edit import items_of
from pytpc.values.rcl_scalars import rcl_text, typed_value
from pytpc.values.scalars import plain_value, same_value
from pytpc.values.yaml_edit import Edit
from pytpc.values.yaml_tree import YamlNode, read_yaml

_GONE = "it is no longer there; give the launch file instead of the mission"
_COMPUTED = "launch computes it: {}; change it by hand"
_ATTRIBUTES = ("value", "default")


def edit_ros2_launch(
    data: bytes, origin: Origin, lineno: int, given: str, *, force: bool = False
) -> Edit:
    """Replace the value of a parameter, or of the argument that it is from.

    Args:
        data: the launch file.
        origin: of the value.
        lineno: of the value; 0 where the file was changed since, so that it is not known.
        given: the new value as typed.
        force: change its type, or an argument that is used elsewhere, too.

    Raises:
        Refused: see docs/how-to/change-a-parameter.md.
    """
    if not lineno:
        raise Refused("the file was changed since; give it instead of the mission")
    assert origin.path is not None
    try:
        return _edit(data, origin, lineno, given, force)
    except Refused as error:
        raise Refused(str(error), error.lineno or lineno) from error


def _edit(data: bytes, origin: Origin, lineno: int, given: str, force: bool) -> Edit:
    assert origin.path is not None
    suffix = origin.path.suffix.lower()
    if suffix == ".py":
        return _edit_python(data, origin, lineno, given, force)
    name = origin.argument or origin.name.rpartition("/")[2]
    notes: tuple[str, ...] = ()
    if origin.argument:
        count = len(re.findall(rb"\$\((?:var|arg)\s+" + re.escape(name).encode() + rb"\b", data))
        if count > 1 and not force:
            raise Refused(
                f"argument {name} is used {count} times here; --force changes all", lineno
            )
        notes = (f"argument {name} is used {count} times here",) if count > 1 else ()
    edit = _edit_yaml if suffix in (".yaml", ".yml") else _edit_xml
    done = edit(data, name, origin.value, lineno, NewText(given, force=force))
    return Edit(done.data, done.old, done.new, done.lineno, notes)


def _new_text(text: str, old: object, new: NewText) -> tuple[object, str]:
    """The new value, and its text where launch reads YAML in a text.

    Raises:
        Refused: launch computes the value, or the new one does not fit.
    """
    if "$(" in text and not new.force:
        raise Refused(_COMPUTED.format(text))
    if isinstance(old, list):
        raise Refused("it is a list; change it by hand")
    value = typed_value(new.text, old, force=new.force)
    if isinstance(value, str):
        # Quotes make a text of what YAML would read as something else.
        return value, value if isinstance(plain_value(value), str) else yaml_text(value, new.text)
    return value, rcl_text(value, new.text, text)


def _edit_xml(data: bytes, name: str, old: object, lineno: int, new: NewText) -> Edit:
    try:
        tags = read_tags(data)
        encoding = encoding_of(data)
    except ValueError as error:
        raise Refused(str(error)) from error
    here = [tag for tag in tags if tag.lineno == lineno and _attribute(tag) is not None]
    named = [tag for tag in here if _is_end_of(_name_of(tag), name)]
    if len(named) != 1:
        raise Refused(_GONE if not named else "several tags of this line set it", lineno)
    attribute = _attribute(named[0])
    assert attribute is not None
    value, text = _new_text(attribute.value, old, new)
    piece = written(text, attribute.quote).encode(encoding)
    after = data[: attribute.start] + piece + data[attribute.end :]
    return Edit(after, old, value, lineno)


def _is_end_of(written: str, name: str) -> bool:
    """Whether a key is the name of a parameter, or the end of it: maps may have the rest."""
    return bool(written) and f".{name}".endswith(f".{written}")


def _attribute(tag: Tag) -> Attribute | None:
    return next((tag.attributes[one] for one in _ATTRIBUTES if one in tag.attributes), None)


def _name_of(tag: Tag) -> str:
    name = tag.attributes.get("name")
    return "" if name is None else name.value


def _edit_yaml(data: bytes, name: str, old: object, lineno: int, new: NewText) -> Edit:
    text = data.decode("utf-8")
    try:
        documents = read_yaml(text)
    except ValueError as error:
        raise Refused(str(error)) from error
    found = [
        value
        for document in documents
        for own, value in _values(document)
        if value.lineno == lineno and _is_end_of(own, name)
    ]
    if len(found) != 1 or found[0].kind != "scalar":
        raise Refused(_GONE if not found else "it is not one value of this line", lineno)
    node = found[0]
    value, inner = _new_text(node.text, old, new)
    # A text in quotes is read as YAML once more.
    piece = f"{node.style}{inner}{node.style}" if node.style in ("'", '"') else inner
    if isinstance(value, str) and not node.style:
        piece = yaml_text(value, new.text)
    after = text[: node.start] + piece + text[node.end :]
    return Edit(after.encode(), old, value, lineno)


def _values(node: YamlNode) -> Iterator[tuple[str, YamlNode]]:
    """The values of ``value`` and ``default`` keys, each with the ``name`` beside it."""
    keys = {key.text: value for key, value in node.pairs}
    name = keys.get("name")
    for key in _ATTRIBUTES:
        if key in keys:
            yield ("" if name is None else name.text), keys[key]
    for _, value in node.pairs:
        yield from _values(value)
    for item in node.items:
        yield from _values(item)


def _edit_python(data: bytes, origin: Origin, lineno: int, given: str, force: bool) -> Edit:
    """Replace a plain literal.

    Raises:
        Refused: it is no plain literal, or several in the line may be meant.
    """
    try:
        tree = ast.parse(data)
    except (SyntaxError, ValueError) as error:
        raise Refused(f"not Python: {error}") from error
    name = origin.argument or origin.name.rpartition("/")[2]
    found = [one for one in _python_values(tree, name) if one.lineno == lineno]
    if len(found) != 1:
        why = "several values of this line may be meant" if found else "no literal is found there"
        raise Refused(f"{why}; change it by hand", lineno)
    node = found[0]
    try:
        old = ast.literal_eval(node)
    except ValueError:
        raise Refused(_COMPUTED.format(ast.unparse(node)), lineno) from None
    start = _offset(data, node.lineno, node.col_offset)
    end = _offset(data, node.end_lineno or node.lineno, node.end_col_offset or 0)
    if isinstance(old, str) and not isinstance(origin.value, str):
        # launch reads the text of an argument as YAML.
        value, inner = _new_text(old, origin.value, NewText(given, force=force))
        piece = _python_text(inner, data[start:end])
    elif isinstance(old, list) and isinstance(node, ast.List):
        return _edit_list(data, node, old, lineno, given)
    elif isinstance(old, bool | int | float | str):
        value = typed_value(given, old, force=force)
        piece = _python_text(value, data[start:end]) if isinstance(value, str) else repr(value)
        if isinstance(value, float) and piece in ("inf", "-inf", "nan"):
            piece = f'float("{piece}")'
    else:
        raise Refused(_COMPUTED.format(ast.unparse(node)), lineno)
    after = data[:start] + piece.encode() + data[end:]
    _check_python(tree, after, node, origin.name)
    return Edit(after, origin.value, value, lineno)


def _edit_list(data: bytes, node: ast.List, old: list[object], lineno: int, given: str) -> Edit:
    """Replace the literals of a list that differ.

    Raises:
        Refused: the new list is of another length or type.
    """
    wanted = items_of(given)
    if wanted is None or len(wanted) != len(old):
        raise Refused(f"the parameter is a list of {len(old)}: give all of it, as in '[1.0, 2.0]'")
    values: list[object] = []
    after = data
    for item, before, one in reversed(list(zip(node.elts, old, wanted, strict=True))):
        value = typed_value(one.text, before)
        values.insert(0, value)
        if not same_value(value, before):
            start = _offset(data, item.lineno, item.col_offset)
            end = _offset(data, item.end_lineno or item.lineno, item.end_col_offset or 0)
            text = _python_text(value, data[start:end]) if isinstance(value, str) else repr(value)
            after = after[:start] + text.encode() + after[end:]
    return Edit(after, old, values, lineno)


def _check_python(tree: ast.Module, after: bytes, node: ast.expr, name: str) -> None:
    """Check that only this literal differs."""
    try:
        new = ast.parse(after)
    except (SyntaxError, ValueError) as error:
        raise Refused(f"{name} cannot be written there: {error}") from error
    place = (node.lineno, node.col_offset)
    one = [ast.dump(n) for n in ast.walk(tree) if isinstance(n, ast.Constant) and _at(n) != place]
    other = [ast.dump(n) for n in ast.walk(new) if isinstance(n, ast.Constant) and _at(n) != place]
    if not isinstance(node, ast.Constant) or one == other:
        return
    if sum(not same_value(a, b) for a, b in zip(one, other, strict=False)):
        raise Refused("it cannot be written without changing other values", node.lineno)


def _at(node: ast.expr) -> tuple[int, int]:
    return node.lineno, node.col_offset


def _python_text(value: str, before: bytes) -> str:
    quote = "'" if before.lstrip(b"rbfuRBFU").startswith(b"'") else '"'
    inner = value.replace("\\", "\\\\").replace(quote, f"\\{quote}").replace("\n", "\\n")
    return f"{quote}{inner}{quote}"


def _python_values(tree: ast.Module, name: str) -> Iterator[ast.expr]:
    """What may be the value of a parameter or argument of this name."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if isinstance(key, ast.Constant) and _is_end_of(str(key.value), name):
                    yield _inner(value)
        elif isinstance(node, ast.Tuple) and len(node.elts) == 2:
            if isinstance(node.elts[0], ast.Constant) and node.elts[0].value == name:
                yield _inner(node.elts[1])
        elif isinstance(node, ast.Call):
            words = {word.arg: word.value for word in node.keywords}
            first = words.get("name", node.args[0] if node.args else None)
            if not isinstance(first, ast.Constant) or first.value != name:
                continue
            second = node.args[1] if len(node.args) > 1 else None
            value_given = words.get("value", words.get("default_value", second))
            if value_given is not None:
                yield _inner(value_given)


def _inner(value: ast.expr) -> ast.expr:
    """What is in a ParameterValue or TextSubstitution."""
    if isinstance(value, ast.Call) and ast.unparse(value.func).rpartition(".")[2] in (
        "ParameterValue",
        "TextSubstitution",
    ):
        words = {word.arg: word.value for word in value.keywords}
        return value.args[0] if value.args else words.get("value", words.get("text", value))
    return value


def _offset(data: bytes, lineno: int, column: int) -> int:
    """The byte of a column, which Python counts in bytes of UTF-8."""
    start = 0
    for _ in range(lineno - 1):
        start = data.index(b"\n", start) + 1
    return start + column
