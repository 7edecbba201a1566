"""From statements of the syntax tree to instructions and control flow.

A ``finally`` is lowered once: a variable of its own stores the way into it, and a dispatch at its
end continues accordingly. Here no call raises; ``raising`` adds the edges of calls that do.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, field

from pytpc.python_analysis.ir.builder import Resolver
from pytpc.python_analysis.ir.exceptions import ALL, names_taken, taken_by
from pytpc.python_analysis.ir.instructions import Block, Handler, Instr, Module, Shape, Variable
from pytpc.python_analysis.ir.lower_expressions import ExpressionLowering
from pytpc.python_analysis.ir.scopes import Scope, names_of

_ENDING = {"exit", "quit", "sys.exit", "os._exit"}


@dataclass
class _Loop:
    after: Block
    head: Block


@dataclass
class _Finally:
    """``exits``: where the dispatch at its end continues, by the number in ``way``."""

    entry: Block
    way: Variable
    handlers: tuple[Handler, ...]
    exits: list[Block] = field(default_factory=list)


class StatementLowering(ExpressionLowering):
    """Lowers the statements of one function; its subclass lowers definitions."""

    def __init__(self, scope: Scope, resolve: Resolver, numbers: list[int]) -> None:
        self._frames: list[_Loop | _Finally] = []
        super().__init__(scope, resolve, numbers)
        self.function.exit = Block(self.function, -1)

    @property
    def _exit(self) -> Block:
        assert self.function.exit is not None
        return self.function.exit

    def statements(self, body: Sequence[ast.stmt]) -> None:
        """Lower statements, one after another."""
        for statement in body:
            lower = getattr(self, f"_do_{type(statement).__name__}", None)
            if lower is not None:
                lower(statement)

    # Simple statements

    def _do_Expr(self, node: ast.Expr) -> None:
        value = self.value(node.value)
        if isinstance(node.value, ast.Call) and ast.unparse(node.value.func) in _ENDING:
            self.emit("raise", node, value, data="SystemExit")
            self._leave_by_raise("SystemExit")

    def _do_Assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self.assign(target, value)

    def _do_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.assign(node.target, self.value(node.value))

    def _do_AugAssign(self, node: ast.AugAssign) -> None:
        target = node.target
        held: list[Instr] = []
        if isinstance(target, ast.Name):
            before = self.name(target.id, target)
        elif isinstance(target, ast.Attribute):
            held = [self.value(target.value)]
            before = self.emit("attr", target, *held, data=target.attr)
        else:
            held = [self.value(target.value), self.value(target.slice)]
            before = self.emit("item", target, *held)
        operand = self.value(node.value)
        result = self.emit("binary", node, before, operand, data=type(node.op).__name__)
        if isinstance(target, ast.Name):
            self.store_name(target.id, result, target)
        elif isinstance(target, ast.Attribute):
            self.emit("setattr", target, *held, result, data=target.attr)
        else:
            self.emit("setitem", target, *held, result)

    def assign(self, target: ast.expr, value: Instr) -> None:
        """Bind a target, which may be a pattern of targets."""
        match target:
            case ast.Name(id=name):
                self.store_name(name, value, target)
            case ast.Attribute(value=holder, attr=attr):
                self.emit("setattr", target, self.value(holder), value, data=attr)
            case ast.Subscript(value=holder, slice=key):
                self.put(self.value(holder), self.value(key), value, target)
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                starred = any(isinstance(part, ast.Starred) for part in parts)
                for index, part in enumerate(parts):
                    self.assign(part, self.part(value, index, starred, part))
            case ast.Starred(value=inner):
                self.assign(inner, self.emit("build", target, value, data="list"))
            case _:
                pass

    def part(self, container: Instr, index: int, starred: bool, node: ast.AST) -> Instr:
        """The element ``index`` of what is unpacked; with a star among the targets, any element."""
        if starred:
            return self.emit("next", node, self.emit("iter", node, container))
        return self.emit("item", node, container, self.emit("const", node, data=index))

    def _do_Delete(self, node: ast.Delete) -> None:
        for target in node.targets:
            if isinstance(target, ast.Attribute | ast.Subscript):
                self.value(target.value)

    def _do_Import(self, node: ast.Import) -> None:
        for alias in node.names:
            name = alias.name if alias.asname else alias.name.split(".")[0]
            found = self.resolve(self.module, alias.name, 0)
            if alias.asname is None and "." in alias.name:
                found = self.resolve(self.module, name, 0)
            self.store_name(alias.asname or name, self._imported(found, node), node)

    def _imported(self, found: Module | str, node: ast.AST) -> Instr:
        if isinstance(found, str):
            return self.emit("external", node, data=found)
        return self.emit("module", node, data=found)

    def _do_ImportFrom(self, node: ast.ImportFrom) -> None:
        name = node.module or ""
        source = self._imported(self.resolve(self.module, name, node.level), node)
        for alias in node.names:
            if alias.name == "*":
                self.stars.append(source)
                continue
            inner = f"{name}.{alias.name}" if name else alias.name
            found = self.resolve(self.module, inner, node.level)
            if isinstance(found, Module):
                value = self._imported(found, node)
            else:
                value = self.emit("attr", node, source, data=alias.name)
            self.store_name(alias.asname or alias.name, value, node)

    def _do_Assert(self, node: ast.Assert) -> None:
        after, failed = self.new_block(), self.new_block()
        self.condition(node.test, after, failed)
        self.block = failed
        self.emit("raise", node, data="AssertionError")
        self._leave_by_raise("AssertionError")
        self.block = after

    def _do_Raise(self, node: ast.Raise) -> None:
        values = [self.value(part) for part in (node.exc, node.cause) if part]
        made = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
        name = ast.unparse(made).rsplit(".", 1)[-1] if made is not None else None
        self.emit("raise", node, *values, data=name)
        self._leave_by_raise(name)

    def _leave_by_raise(self, name: str | None) -> None:
        """Go to the handlers that may catch an exception of the class ``name``."""
        taken, through = taken_by(self.handlers, name)
        self.block.successors += [handler.block for handler in taken]
        if through:
            self.jump(self._exit)
        self.block = self.new_block()

    def _do_Return(self, node: ast.Return) -> None:
        if node.value is not None:
            self.emit("return", node, self.value(node.value))
        self._unwind(0)
        self.jump(self._exit)
        self.block = self.new_block()

    def _unwind(self, depth: int) -> None:
        """Run the ``finally`` of all frames from ``depth`` on, the innermost first."""
        frames, handlers = self._frames, self.handlers
        for index in range(len(frames) - 1, depth - 1, -1):
            frame = frames[index]
            if isinstance(frame, _Finally):
                self.handlers = frame.handlers
                self._through(frame)
        self.handlers = handlers

    def _through(self, frame: _Finally) -> None:
        """Run a ``finally``, and continue in a new block behind it."""
        number = self.emit("const", ast.Pass(), data=len(frame.exits))
        self.emit("store", ast.Pass(), number, data=frame.way)
        self.jump(frame.entry)
        self.block = self.new_block()
        frame.exits.append(self.block)

    def _do_Break(self, _: ast.Break) -> None:
        self._leave_loop(to_head=False)

    def _do_Continue(self, _: ast.Continue) -> None:
        self._leave_loop(to_head=True)

    def _leave_loop(self, to_head: bool) -> None:
        for index in range(len(self._frames) - 1, -1, -1):
            frame = self._frames[index]
            if isinstance(frame, _Loop):
                self._unwind(index + 1)
                self.jump(frame.head if to_head else frame.after)
                break
        self.block = self.new_block()

    # Compound statements

    def _do_If(self, node: ast.If) -> None:
        yes, after = self.new_block(), self.new_block()
        no = self.new_block() if node.orelse else after
        self.condition(node.test, yes, no)
        self._inside(yes, node.body, after)
        if node.orelse:
            self._inside(no, node.orelse, after)
        self.block = after

    def _inside(self, block: Block, body: Sequence[ast.stmt], after: Block) -> None:
        self.block = block
        self.statements(body)
        self.jump(after)

    def _do_While(self, node: ast.While) -> None:
        head, body, after = self.new_block(), self.new_block(), self.new_block()
        done = self.new_block() if node.orelse else after
        self.jump(head)
        self.block = head
        self.condition(node.test, body, done)
        self._loop(body, node.body, head, after)
        if node.orelse:
            self._inside(done, node.orelse, after)
        self.block = after

    def _loop(self, block: Block, body: Sequence[ast.stmt], head: Block, after: Block) -> None:
        self._frames.append(_Loop(after, head))
        self._inside(block, body, head)
        self._frames.pop()

    def _do_For(self, node: ast.For | ast.AsyncFor) -> None:
        known = None if _rebinds(node) else self.known_elements(node.target, node.iter)
        if known is not None:
            self._unrolled(node, known)
            return
        source = self.emit("iter", node.iter, self.value(node.iter))
        head, body, after = self.new_block(), self.new_block(), self.new_block()
        done = self.new_block() if node.orelse else after
        self.jump(head)
        self.block = head
        self.branch(self.emit("more", node.iter, source), node.iter, body, done)
        self.block = body
        self.assign(node.target, self.emit("next", node.iter, source))
        self._loop(body, node.body, head, after)
        if node.orelse:
            self._inside(done, node.orelse, after)
        self.block = after

    _do_AsyncFor = _do_For

    def _unrolled(self, node: ast.For | ast.AsyncFor, known: list[dict[str, object]]) -> None:
        """One body for each of the constants that the loop iterates over."""
        after = self.new_block()
        for names in known:
            further = self.new_block()
            for name, value in names.items():
                constant = self.emit("const", node.target, data=value)
                self.store_name(name, constant, node.target)
            self.scope.renamed.append(dict(names))
            self._loop(self.block, node.body, further, after)
            self.scope.renamed.pop()
            self.block = further
        self.statements(node.orelse)
        self.jump(after)
        self.block = after

    def _do_With(self, node: ast.With | ast.AsyncWith) -> None:
        leaving = []
        for item in node.items:
            manager = self.value(item.context_expr)
            method = self.emit("attr", item.context_expr, manager, data="__enter__")
            entered = self.emit("call", item.context_expr, method, data=Shape(()))
            if item.optional_vars is not None:
                self.assign(item.optional_vars, entered)
            leaving.append((item.context_expr, manager))
        self.statements(node.body)
        for expression, manager in reversed(leaving):
            method = self.emit("attr", expression, manager, data="__exit__")
            self.emit("call", expression, method, data=Shape(()))

    _do_AsyncWith = _do_With

    def _do_Try(self, node: ast.Try) -> None:
        outer = self.handlers
        opened, after = self.block, self.new_block()
        if node.finalbody:
            frame = _Finally(self.new_block(), self.temporary(), outer)
            frame.entry.opened = opened
            self.handlers = (Handler(self._raised_through(frame, opened), ALL), *outer)
            self._frames.append(frame)
        around = self.handlers
        handlers = []
        for handler in node.handlers:
            block = self.new_block()
            block.opened = opened
            handlers.append(Handler(block, names_taken(handler)))
        self.handlers = (*handlers, *around)
        body = self.new_block()
        self.jump(body)
        self.block = body
        self.statements(node.body)
        self.handlers = around
        done = self.new_block()
        self.jump(done)
        self.block = done
        self.statements(node.orelse)
        joined = self.new_block()
        self.jump(joined)
        for handler, way in zip(node.handlers, handlers, strict=True):
            self.block = way.block
            if handler.name:
                caught = self.emit("build", handler, data="exception")
                self.store_name(handler.name, caught, handler)
            self.statements(handler.body)
            self.jump(joined)
        self.handlers = outer
        self.block = joined
        if node.finalbody:
            self._frames.pop()
            self._through(frame)
            further = self.block
            self._finally(node, frame)
            self.block = further
        self.jump(after)
        self.block = after

    _do_TryStar = _do_Try

    def _finally(self, node: ast.Try, frame: _Finally) -> None:
        self.block = frame.entry
        self.statements(node.finalbody)
        if len(frame.exits) > 1:
            self.emit("dispatch", ast.Pass(), self.emit("load", ast.Pass(), data=frame.way))
        self.block.successors += frame.exits

    def _raised_through(self, frame: _Finally, opened: Block) -> Block:
        """The block by which an exception enters a ``finally``, behind which it is raised again."""
        before = self.block
        block = self.new_block()
        block.opened = opened
        self.block = block
        self._through(frame)
        taken, through = taken_by(self.handlers, None)
        self.block.successors += [handler.block for handler in taken]
        if through:
            self.jump(self._exit)
        self.block = before
        return block


def _rebinds(node: ast.For | ast.AsyncFor) -> bool:
    """True where the loop's body binds the names of the loop."""
    own = {part.id for part in ast.walk(node.target) if isinstance(part, ast.Name)}
    return bool(own & names_of(node.body).bound)
