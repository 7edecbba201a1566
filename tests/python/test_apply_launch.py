"""Changing one value in a launch file: what changes, and what is refused."""

from __future__ import annotations

import pytest

from pytpc.values.launch_edit import NewText, add_param, edit_argument, edit_inline, edit_param
from pytpc.values.launch_xml import read_tags
from pytpc.values.new_value import Refused, launch_value


def param(attributes: str) -> str:
    return f"<launch>\n  <!-- a -->\n  <param {attributes}/>  <!-- b -->\n</launch>"


# The attributes, what is given, the attributes afterwards.
CHANGES = [
    ('name="x" value="0.5"', "0.7", 'name="x" value="0.7"'),
    # Other quotes, blanks and orders; an entity before it.
    ("value = '0.5'   name='x'", "0.7", "value = '0.7'   name='x'"),
    ('doc="a &gt; b"\n  name="x"\n  value="0.5"', "2", 'doc="a &gt; b"\n  name="x"\n  value="2.0"'),
    # Without a type roslaunch takes a number with a dot for a float, and 1e-07 for a text.
    ('name="x" value="0.5"', "1e-7", 'name="x" value="1.0e-07"'),
    ('name="x" value="0.5" type="double"', "2", 'name="x" value="2" type="double"'),
    ('name="x" value="7"', "8.0", 'name="x" value="8"'),
    ('name="x" value="True"', "false", 'name="x" value="False"'),
    ('name="x" value="1" type="bool"', "off", 'name="x" value="0" type="bool"'),
    ('name="x" value="map"', "odom", 'name="x" value="odom"'),
    ('name="x" value="map"', 'a<"b"&c', 'name="x" value="a&lt;&quot;b&quot;&amp;c"'),
    ('name="x" value="5" type="str"', "6", 'name="x" value="6" type="str"'),
    ('name="x" value="yes" type="yaml"', "off", 'name="x" value="no" type="yaml"'),
    ('name="~x" value="3"', "4", 'name="~x" value="4"'),
]


@pytest.mark.parametrize(("before", "given", "after"), CHANGES)
def test_a_param(before: str, given: str, after: str) -> None:
    edit = edit_param(param(before).encode(), "/n/x", 3, given)
    assert edit.data.decode() == param(after)


@pytest.mark.parametrize(
    ("attributes", "given", "said"),
    [
        ('name="x" value="7"', "7.5", "a whole number"),
        ('name="x" value="0.5"', "inf", "give the tag a type"),
        ('name="x" value="map"', "5", "give the tag a type"),
        ('name="x" value="$(eval 1+2)"', "5", "roslaunch computes its value"),
        ('name="x" command="date"', "5", "the output of a command"),
        ('name="x" value="{a: 1}" type="yaml"', "5", 'type="yaml"'),
        ('name="y" value="7"', "8", "the <param> for /n/x is gone"),
    ],
)
def test_a_param_that_is_refused(attributes: str, given: str, said: str) -> None:
    with pytest.raises(Refused) as refused:
        edit_param(param(attributes).encode(), "/n/x", 3, given)
    assert said in str(refused.value)


@pytest.mark.parametrize("text", ['8"/><param name="y" value="9', '8" b="9', "8<", "9 "])
def test_a_text_that_would_say_something_else_is_not_written(monkeypatch, text: str) -> None:
    """The net below all else: whatever the new file is, it is read before it is written."""
    monkeypatch.setattr("pytpc.values.launch_edit.written", lambda *_: text)
    with pytest.raises(Refused, match=r"cannot be written without changing|not XML"):
        edit_param(param('name="x" value="7"').encode(), "/x", 3, "8")


def test_what_roslaunch_works_out_is_replaced_by_force() -> None:
    data = param('name="x" value="$(eval 1+2)"').encode()
    edit = edit_param(data, "/n/x", 3, "0.5", force=True)
    assert edit.data.decode() == param('name="x" value="0.5"')
    assert edit.notes == ("$(eval 1+2) is replaced by a value",)


def test_a_line_that_has_moved() -> None:
    """The tag is found by its name where there is one; where there are two, the line decides."""
    one = param('name="x" value="1"').encode()
    assert b'value="2"' in edit_param(one, "/n/x", 9, "2").data
    two = b'<launch>\n<param name="x" value="1"/>\n<param name="x" value="5"/>\n</launch>'
    assert edit_param(two, "/x", 3, "6").data == two.replace(b'"5"', b'"6"')
    with pytest.raises(Refused, match="give the launch file"):
        edit_param(two, "/x", 9, "6")


ENCODED = '<?xml version="1.0" encoding="iso-8859-1"?>\n<launch>\n<!-- é -->\n{}\n</launch>'


def test_an_encoding_is_kept() -> None:
    before = ENCODED.format('<param name="x" value="ä"/>').encode("latin-1")
    edit = edit_param(before, "/x", 4, "ö")
    assert edit.data == ENCODED.format('<param name="x" value="ö"/>').encode("latin-1")
    with pytest.raises(Refused, match=r"the file is in iso8859-1, which has no"):
        edit_param(before, "/x", 4, "→")
    with pytest.raises(Refused, match="UTF-16 is not handled"):
        edit_param("<launch/>".encode("utf-16"), "/x", 1, "1")


def test_a_byte_order_mark_and_line_endings_stay() -> None:
    before = b'\xef\xbb\xbf<launch>\r\n\t<param name="x" value="1"/>\r\n</launch>\r\n'
    assert edit_param(before, "/x", 2, "2").data == before.replace(b'"1"', b'"2"')


ARGUMENTS = b"""<launch>
  <arg name="rate" default="4.0"/>
  <arg name="seed" default="1"/>
  <param name="rate" value="$(arg rate)"/>
  <param name="a" value="$(arg seed)"/>
  <node name="n" pkg="p" type="t" args="--seed $(arg seed)"/>
</launch>
"""


def test_an_argument() -> None:
    edit = edit_argument(ARGUMENTS, "rate", 2, NewText("2"), via=[4])
    # The parameter has no type: without a dot it would be an int.
    assert edit.data == ARGUMENTS.replace(b'"4.0"', b'"2.0"')
    assert (edit.old, edit.new, edit.lineno) == (4.0, 2.0, 2)


def test_an_argument_that_is_passed_on_with_all_others() -> None:
    before = ARGUMENTS.replace(
        b"</launch>", b'  <include file="b.launch" pass_all_args="true"/>\n</launch>'
    )
    with pytest.raises(Refused, match="<arg> rate is used in line 7, too; --force changes all"):
        edit_argument(before, "rate", 2, NewText("2"), via=[4])
    # The parameter gets it through that very include.
    edit = edit_argument(before, "rate", 2, NewText("2"), via=[4, 7])
    assert edit.data == before.replace(b'"4.0"', b'"2.0"')


def test_an_argument_that_is_used_elsewhere() -> None:
    with pytest.raises(Refused, match="<arg> seed is used in line 6, too; --force changes all"):
        edit_argument(ARGUMENTS, "seed", 3, NewText("2"), via=[5])
    edit = edit_argument(ARGUMENTS, "seed", 3, NewText("2", force=True), via=[5])
    assert edit.data == ARGUMENTS.replace(b'"1"', b'"2"')
    assert edit.notes == ("line 6 uses <arg> seed, too, and changes with it",)


INLINE = """<launch>
  <rosparam param="other">{{speed: 9}}</rosparam>
  <rosparam>{open}
    # a < b
    speed: {value}   # m/s
    list: [1, 2]
  {close}</rosparam>
</launch>
"""


def test_yaml_in_a_launch_file() -> None:
    section = {"open": "<![CDATA[", "close": "]]>"}
    before = INLINE.format(value="1.5", **section).encode()
    edit = edit_inline(before, ("speed",), 5, "2.5")
    assert edit.data.decode() == INLINE.format(value="2.5", **section)
    assert edit.lineno == 5
    plain = INLINE.replace("a < b", "a").format(value="1.5", open="", close="").encode()
    assert edit_inline(plain, ("speed",), 5, "2.5").data == plain.replace(b"1.5", b"2.5")
    with pytest.raises(Refused, match="the <rosparam> with it is gone"):
        edit_inline(plain, ("speed",), 8, "2.5")


def test_yaml_in_a_launch_file_must_stay_xml() -> None:
    before = b"<launch><rosparam>\nname: x\n</rosparam></launch>"
    with pytest.raises(Refused, match="are special in XML"):
        edit_inline(before, ("name",), 2, "a<b")
    section = b"<launch><rosparam><![CDATA[\nname: x\n]]></rosparam></launch>"
    assert b"'a<b'" in edit_inline(section, ("name",), 2, "a<b").data
    with pytest.raises(Refused, match="are special in XML"):
        edit_inline(section, ("name",), 2, "a]]>b")


# --- what nobody set


def node_offset(data: bytes) -> int:
    return data.index(b"<node")


ADDED = [
    # A closed tag is opened.
    ('  <node name="n" pkg="p" type="t" />\n',
     '  <node name="n" pkg="p" type="t">\n'
     '    <param name="x" value="0.5" type="double"/>\n  </node>\n'),
    # What is there keeps its place, and its indentation is taken.
    ('  <node name="n">\n      <remap from="a" to="b"/>\n  </node>\n',
     '  <node name="n">\n      <remap from="a" to="b"/>\n'
     '      <param name="x" value="0.5" type="double"/>\n  </node>\n'),
    ('\t<node name="n"></node>\n',
     '\t<node name="n">\n\t  <param name="x" value="0.5" type="double"/>\n\t</node>\n'),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after"), ADDED)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_added_to_a_node(before: str, after: str, newline: str) -> None:
    whole, wanted = (
        f"<launch>\n{text}</launch>\n".replace("\n", newline).encode() for text in (before, after)
    )
    edit = add_param(whole, node_offset(whole), "x", 0.5, "0.5")
    assert edit.data == wanted
    assert edit.data.splitlines()[edit.lineno - 1].strip().startswith(b"<param")


def test_added_to_the_end() -> None:
    edit = add_param(b"<launch>\n  <arg name='a'/>\n</launch>\n", None, "/n/x", "a b", "a b")
    assert edit.data == (
        b'<launch>\n  <arg name=\'a\'/>\n  <param name="/n/x" value="a b" type="str"/>\n</launch>\n'
    )
    with pytest.raises(Refused, match="the tag of the node is no longer there"):
        add_param(b"<launch></launch>", 3, "x", 1, "1")


# --- values as roslaunch reads them


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("5", "auto", 5),
        ("5.0", "auto", 5.0),
        ("1e3", "auto", "1e3"),
        ("1_0", "auto", "1_0"),
        ("True", "auto", True),
        ("yes", "auto", "yes"),
        ("1.2.3", "auto", "1.2.3"),
        (" 5 ", "str", "5"),
        ("1", "bool", True),
        ("1e3", "double", 1000.0),
        ("yes", "yaml", True),
    ],
)
def test_values(text: str, kind: str, value: object) -> None:
    assert repr(launch_value(text, kind)) == repr(value)


@pytest.mark.parametrize(
    ("text", "kind"), [("5.5", "int"), ("x", "double"), ("2", "bool"), ("1", "odd")]
)
def test_values_that_do_not_fit(text: str, kind: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        launch_value(text, kind)


# --- places


def test_the_places_of_tags() -> None:
    data = b"<launch>\n <a x = 'p>q' y=\"&#65;&#x42;&amp;lt;\"/>\n <b><c/></b></launch>"
    tags = {tag.name: tag for tag in read_tags(data)}
    attribute = tags["a"].attributes["x"]
    assert data[attribute.start : attribute.end] == b"p>q"
    assert tags["a"].attributes["y"].value == "AB&lt;"
    assert (tags["a"].lineno, tags["a"].closed, tags["b"].closed) == (2, True, False)
    assert data[tags["b"].end :].startswith(b"</b>")
    assert tags["c"].parent is tags["b"]
    with pytest.raises(ValueError, match="not XML in line 2"):
        read_tags(b"<launch>\n<a>")


def test_white_space_in_attributes() -> None:
    (tag,) = read_tags(b"<param value='a\r\nb\tc &lt;&#65;&#x42;&quot;'/>")
    assert tag.attributes["value"].value == 'a b c <AB"'
