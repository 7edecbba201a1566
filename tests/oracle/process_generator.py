"""Makes random programs of several link units: an executable, two libraries and two plugins.

A chain begins with a parameter that one unit reads. Another one compares it, and a third one
publishes what comes of that. Some chains are twins, in which a step is missing. What is true is not
known here: `process_run` executes the program to find out.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field

HEADER = """#include <ros/ros.h>

double sensed();
#ifdef TRUTH
bool truth(int Site, double Value, double Threshold, bool Outcome);
#define SITE(N, V, OP, T) truth(N, V, T, (V)OP(T))
#define FLAG(N, T) truth(N, T, T, T)
#else
#define SITE(N, V, OP, T) ((V)OP(T))
#define FLAG(N, T) (T)
#endif

namespace class_loader {
namespace impl {
template <class B> struct AbstractMetaObject { virtual B *create() const = 0; };
template <class C, class B> struct MetaObject : AbstractMetaObject<B> {
  B *create() const override { return new C; }
};
} // namespace impl
} // namespace class_loader
"""
# As class_loader keeps it.
REGISTRY = """#include <cstring>
Plugin *Plug0, *Plug1;
static const char *Names[8];
static Factory *Known[8];
static int Count;
void add(const char *Name, Factory *Made) {
  Names[Count] = Name;
  Known[Count++] = Made;
}
Factory *find(const char *Name) {
  int Number = 0;
  while (std::strcmp(Names[Number], Name))
    ++Number;
  return Known[Number];
}"""
MAIN = "robot"
LIBRARIES = ("left", "right")
PLUGINS = ("careful", "direct")
UNITS = (MAIN, *LIBRARIES, *PLUGINS)
ROUNDS = 40


@dataclass
class Source:
    """A source file, in the order of its parts."""

    globals: list[str] = field(default_factory=list)
    begin: list[str] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    virtual: list[str] = field(default_factory=list)
    unloaded: list[str] = field(default_factory=list)


@dataclass
class Text:
    """The files of a program, and its parameters with their values."""

    files: dict[str, str]
    parameters: dict[str, str]
    without: tuple[str, ...] = ("Unloaded",)


class Maker:
    """Puts chains together."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.sources = {unit: Source() for unit in UNITS}
        self.shared: list[str] = []
        self.interface: list[str] = []
        self.each_round: list[str] = []
        self.start: list[str] = []
        self.parameters: dict[str, str] = {}
        self.sites = 0
        self.has_gate = False

    def program(self, chains: int) -> Text:
        for number in range(chains):
            self.chain(number)
        return Text(self.files(), self.parameters)

    # Parts of a chain.

    def parameter(self, name: str, kind: str) -> str:
        """A parameter, and the name of the type of its variable."""
        if kind == "bool":
            self.parameters[name] = "1"
        elif kind == "int":
            self.parameters[name] = str(self.random.randint(3, 6))
        else:
            # No two are alike: they tell whose threshold one is.
            self.parameters[name] = f"{self.random.randint(30, 60) / 10 + 0.001 * self.sites:.3f}"
        return kind

    def read(self, unit: str, number: int, name: str, kind: str, *, local: bool) -> str:
        """Let a unit read a parameter; what its value is called there."""
        source = self.sources[unit]
        scope = "static " if local else ""
        default = {"bool": "false", "int": "4", "double": "4.5"}[kind]
        if self.random.random() < 0.5:
            variable = f"{name.upper()}"
            source.globals.append(f"{scope}{kind} {variable} = {default};")
            if not local:
                self.shared.append(f"extern {kind} {variable};")
        else:
            box = f"Box{name.upper()}"
            declared = f"struct {box} {{ int Unused; {kind} Limit; }};"
            (source.globals if local else self.shared).append(declared)
            source.globals.append(f"{scope}{box} In{box} = {{0, {default}}};")
            if not local:
                self.shared.append(f"extern {box} In{box};")
            variable = f"In{box}.Limit"
        way = self.random.randrange(3)
        if way == 0:
            source.begin.append(f'Handle.getParam("{name}", {variable});')
        elif way == 1:
            source.begin.append(f'Handle.param("{name}", {variable}, {kind}({default}));')
        else:
            source.begin.append(f'{variable} = Handle.param<{kind}>("{name}", {default});')
        return variable

    def outcome(self, kind: str, threshold: str) -> str:
        """Code that returns the outcome of a comparison of `Value` with the threshold."""
        number = self.sites
        self.sites += 1
        # The place of a flag that is passed on would be where it is read.
        if kind == "bool":
            return f"if (FLAG({number}, {threshold}))\n  return true;\nreturn false;"
        if self.random.random() < 0.3:
            threshold = self.random.choice([f"{threshold} + 1", f"{threshold} * 1.25"])
        relation = self.random.choice([">", "<", ">=", "<="])
        site = f"SITE({number}, Value, {relation}, {threshold})"
        if self.random.random() < 0.5:
            return f"if ({site})\n  return true;\nreturn false;"
        return f"return {site};"

    def function(self, unit: str, caller: str, name: str, head: tuple[str, str], body: str) -> str:
        """A function of `unit` with (result, argument); what `caller` calls it by."""
        result, argument = head
        source = self.sources[unit]
        kind = argument.split()[0] if argument else ""
        if unit in PLUGINS:
            default = "" if result == "void" else " return {};"
            self.interface.append(f"virtual {result} {name}({argument}) {{{default} }}")
            source.virtual.append(f"{result} {name}({argument}) override {{\n{body}\n}}")
            return name if unit == caller else f"Plug{PLUGINS.index(unit)}->{name}"
        local = unit == caller and self.random.random() < 0.5
        source.functions.append(
            f"{'static ' if local else ''}{result} {name}({argument}) {{\n{body}\n}}"
        )
        if not local:
            self.shared.append(f"{result} {name}({argument});")
        if unit == caller or unit in LIBRARIES:
            return name
        # Libraries cannot name what the executable has: it hands a pointer over.
        pointer = f"Of_{name}"
        self.shared.append(f"extern {result} (*{pointer})({kind});")
        self.sources["left"].globals.append(f"{result} (*{pointer})({kind});")
        self.start.append(f"{pointer} = &{name};")
        return pointer

    def chain(self, number: int) -> None:
        choose = self.random.choice
        kind = choose(["double", "double", "int", "bool"])
        name = f"p{number}"
        self.parameter(name, kind)
        reads, compares, exposes = choose(UNITS), choose(UNITS), choose(UNITS)
        if kind == "double" and self.random.random() < 0.3:
            check = self.gate(number, name, compares, exposes)
            self.expose(number, exposes, check)
            return
        value = self.value(number, name, kind, reads, compares)
        check = self.check(number, kind, compares, exposes, value)
        self.expose(number, exposes, check)

    def value(self, number: int, name: str, kind: str, reads: str, compares: str) -> str:
        """How the unit that compares gets the value."""
        near = reads == compares
        way = self.random.choice(["own", "get", "set"])
        if near and way == "own":
            return self.read(reads, number, name, kind, local=True)
        if reads in LIBRARIES and way == "own":
            return self.read(reads, number, name, kind, local=False)
        variable = self.read(reads, number, name, kind, local=True)
        if way != "set":
            get = self.function(reads, compares, f"get{number}", (kind, ""), f"return {variable};")
            return f"{get}()"
        held = f"Held{number}"
        self.sources[compares].globals.append(f"static {kind} {held};")
        set_ = self.function(
            compares, reads, f"set{number}", ("void", f"{kind} To"), f"{held} = To;"
        )
        # All units have begun.
        push = self.function(reads, MAIN, f"push{number}", ("void", ""), f"{set_}({variable});")
        self.start.append(f"{push}();")
        return held

    def gate(self, number: int, name: str, owner: str, exposes: str) -> str:
        """An object of a class that all units use, with a limit of its own."""
        if not self.has_gate:
            self.has_gate = True
            self.shared.append(
                "struct Gate {\n  bool passes(double Value) const;\n  double Limit = 4.5;\n};"
            )
            self.sources["right"].functions.append(
                f"bool Gate::passes(double Value) const {{\n{self.outcome('double', 'Limit')}\n}}"
            )
        self.sites += 1  # so that its value is another one
        gate = f"Gate{number}"
        self.sources[owner].globals.append(f"static Gate {gate};")
        self.sources[owner].begin.append(f'{gate}.Limit = Handle.param<double>("{name}", 4.5);')
        head = ("bool", "double Value")
        return self.function(
            owner, exposes, f"check{number}", head, f"return {gate}.passes(Value);"
        )

    def check(self, number: int, kind: str, compares: str, exposes: str, value: str) -> str:
        """The function that compares; what the unit that exposes calls it by."""
        head = ("bool", "double Value")
        name = f"check{number}"
        if compares in PLUGINS:
            self.unloaded_twin(number, compares, kind)
        if self.random.random() < 0.5:
            self.helper(compares, number, kind)
            if compares in PLUGINS:
                self.twin_of_helper(number, kind, compares)
            body = f"return passes{number}(Value, {value});"
        else:
            body = self.outcome(kind, value)
        return self.function(compares, exposes, name, head, body)

    def helper(self, unit: str, number: int, kind: str) -> None:
        self.sources[unit].globals.append(
            f"bool passes{number}(double Value, {kind} Limit) {{\n{self.outcome(kind, 'Limit')}\n}}"
        )

    def twin_of_helper(self, number: int, kind: str, compares: str) -> None:
        """The other plugin has a function of the same name, whose outcome says nothing."""
        (other,) = (unit for unit in PLUGINS if unit != compares)
        name = f"r{number}"
        self.parameter(name, kind)
        variable = self.read(other, number, name, kind, local=True)
        self.helper(other, number, kind)
        self.sources[other].globals.append(f"static int Passed{number};")
        idle = self.function(
            other,
            MAIN,
            f"idle{number}",
            ("void", "double Value"),
            f"if (passes{number}(Value, {variable}))\n  ++Passed{number};",
        )
        self.each_round.append(f"{idle}(sensed());")

    def unloaded_twin(self, number: int, unit: str, kind: str) -> None:
        """A plugin of the same library that the process does not load."""
        if unit != PLUGINS[0] or self.random.random() < 0.4:
            return
        name = f"u{number}"
        self.parameter(name, kind)
        default = "false" if kind == "bool" else "2"
        self.sources[unit].unloaded.append(
            f"bool check{number}(double Value) override {{\n"
            f"  {kind} Limit = {default};\n"
            f'  ros::NodeHandle().getParam("{name}", Limit);\n'
            f"{self.outcome(kind, 'Limit')}\n}}"
        )

    def expose(self, number: int, unit: str, check: str) -> None:
        ways = ["if", "data", "store", "early", "count"]
        # A method that overrides another one counts as called.
        way = self.random.choice(ways if unit in PLUGINS else [*ways, "never"])
        source = self.sources[unit]
        out, call = f"Out{number}", f"{check}(Value)"
        send = f"{out}.publish(Message)"
        source.globals.append(f"static ros::Publisher {out};")
        source.globals.append(f"static int Ignored{number};")
        source.begin.append(f'{out} = Handle.advertise<std_msgs::Number>("out{number}", 1);')
        first = "std_msgs::Number Message;"
        body = {
            "if": f"{first}\nif ({call})\n  {send};",
            "data": f"{first}\nMessage.data = {call} ? 1 : 2;\n{send};",
            "store": f"{first}\nif (Seen{number})\n  {send};\nSeen{number} = {call};",
            "early": f"{first}\nif (!{call})\n  return;\n{send};",
            "count": f"{first}\nif ({call})\n  ++Ignored{number};\n{send};",
            "never": f"{first}\nif ({call})\n  {send};",
        }[way]
        if way == "store":
            source.globals.append(f"static bool Seen{number};")
        run = self.function(unit, MAIN, f"run{number}", ("void", "double Value"), body)
        if way != "never":
            self.each_round.append(f"{run}(sensed());")

    # Text.

    def files(self) -> dict[str, str]:
        methods = [f"  {line}" for line in self.interface]
        interface = [
            "struct Plugin {",
            "  virtual ~Plugin() {}",
            "  virtual void begin(ros::NodeHandle &Handle) = 0;",
            *methods,
            "};",
            "using Factory = class_loader::impl::AbstractMetaObject<Plugin>;",
            "void add(const char *Name, Factory *Made);",
            "Factory *find(const char *Name);",
            "extern Plugin *Plug0, *Plug1;",
            *(f"void begin_{unit}(ros::NodeHandle &Handle);" for unit in LIBRARIES),
        ]
        shared = list(dict.fromkeys(self.shared))
        found = {"shared.h": "\n".join([HEADER, *interface, *shared, ""])}
        for unit in LIBRARIES:
            found[f"{unit}.cpp"] = self.library(unit)
        for number, unit in enumerate(PLUGINS):
            found[f"{unit}.cpp"] = self.plugin(unit, number)
        found["robot.cpp"] = self.robot()
        return found

    def robot(self) -> str:
        source = self.sources[MAIN]
        opened = list(enumerate(PLUGINS))
        self.random.shuffle(opened)
        start = [
            "ros::NodeHandle Handle;",
            *(f'dlopen("lib{name}.so", RTLD_LAZY);' for _, name in opened),
            *(f'Plug{number} = find("Plug{number}")->create();' for number, _ in opened),
            *(f"begin_{unit}(Handle);" for unit in LIBRARIES),
            *source.begin,
            *(f"Plug{number}->begin(Handle);" for number, _ in opened),
            *self.start,
        ]
        return "\n".join(
            [
                '#include "shared.h"',
                "#include <dlfcn.h>",
                *source.globals,
                *source.functions,
                "int main() {",
                *indented(start),
                f"  for (int Round = 0; Round < {ROUNDS}; ++Round) {{",
                *indented(indented(self.each_round)),
                "  }",
                "}",
                "",
            ]
        )

    def library(self, unit: str) -> str:
        source = self.sources[unit]
        return "\n".join(
            [
                '#include "shared.h"',
                *([REGISTRY] if unit == LIBRARIES[0] else []),
                *source.globals,
                *source.functions,
                f"void begin_{unit}(ros::NodeHandle &Handle) {{",
                *indented(source.begin),
                "}",
                "",
            ]
        )

    def plugin(self, unit: str, number: int) -> str:
        source = self.sources[unit]
        name = unit.capitalize()
        classes = [(name, f"Plug{number}", source.virtual, source.begin)]
        if number == 0:
            classes.append(("Unloaded", "Unloaded", source.unloaded, []))
        lines = ['#include "shared.h"', *source.globals]
        for kind, _, methods, begin in classes:
            lines += [
                f"struct {kind} : Plugin {{",
                "  void begin(ros::NodeHandle &Handle) override {",
                *indented(indented(begin)),
                "  }",
                *indented(methods),
                "};",
            ]
        for kind, known, _, _ in classes:
            lines += [
                f"static class_loader::impl::MetaObject<{kind}, Plugin> Make{kind};",
                f'static int Added{kind} = (add("{known}", &Make{kind}), 0);',
            ]
        return "\n".join([*lines, ""])


def indented(texts: Sequence[str]) -> list[str]:
    return [f"  {line}" for text in texts for line in text.splitlines()]


def process(seed: int, chains: int = 12) -> Text:
    """The program of a seed: always the same."""
    return Maker(seed).program(chains)
