"""Small changes of Python code, as people make them by mistake."""

import ast
import dataclasses
import hashlib
from collections.abc import Callable, Iterator
from typing import Any

_COMPARE: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_BINARY: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Div,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.Pow: ast.Mult,
}  # fmt: skip
_NAMES = {
    "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "argmin": "argmax", "argmax": "argmin",
    "any": "all", "all": "any", "floor": "ceil", "ceil": "floor", "cos": "sin", "sin": "cos", "median": "max",
}  # fmt: skip

#: Functions whose arguments may change places.
_SYMMETRIC = frozenset(
    {"max", "min", "maximum", "minimum", "logical_and", "logical_or", "hypot", "allclose", "isclose", "cw_mul", "dot"}
)


@dataclasses.dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
      file: path from the repository's root.
      line: first line of what changes.
      statement: of the statement it is in.
      before, after: its code.
      source: the whole changed module.
    """

    file: str
    line: int
    statement: int
    before: str
    after: str
    source: str = dataclasses.field(repr=False)

    @property
    def name(self) -> str:
        """12 hexadecimal digits over the module as it is with the change."""
        return hashlib.sha256(f"{self.file}\0{self.source}".encode()).hexdigest()[:12]


def places_of(source: str) -> list[tuple[int, int]]:
    """Every change of a module as (number of its node, number of the change there); see `plant`.

    None in annotations, docstrings, decorators or raised exceptions.
    """
    tree = ast.parse(source)
    nodes = list(ast.walk(tree))
    skipped = {inner for node in nodes for part in _not_code(node) for inner in ast.walk(part)}
    free = ((n, node) for n, node in enumerate(nodes) if node not in skipped and isinstance(node, ast.expr | ast.stmt))
    return [(n, k) for n, node in free for k in range(len(list(_changes(node))))]


def plant(file: str, source: str, place: tuple[int, int]) -> Mutant:
    """The change of a module at one of its `places_of`."""
    tree = ast.parse(source)
    node = list(ast.walk(tree))[place[0]]
    before, line = ast.unparse(node), getattr(node, "lineno", 0)
    around = [x.lineno for x in ast.walk(tree) if isinstance(x, ast.stmt) and node in ast.walk(x)]
    list(_changes(node))[place[1]](node)
    return Mutant(file, line, max(around), before, ast.unparse(node), ast.unparse(tree) + "\n")


def _not_code(node: ast.AST) -> Iterator[ast.AST]:
    """Parts of a node that are no code: annotations, standalone strings, raised exceptions, conditions of imports."""
    if isinstance(node, ast.arg | ast.AnnAssign) and node.annotation is not None:
        yield node.annotation
    elif isinstance(node, ast.FunctionDef):
        yield from [node.returns] if node.returns is not None else []
        yield from node.decorator_list
    elif isinstance(node, ast.ClassDef):
        yield from node.decorator_list
    elif isinstance(node, ast.Raise | ast.Assert):
        yield node
    elif (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)) or (
        isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ):
        yield node


def _changes(node: ast.AST) -> Iterator[Callable[[Any], None]]:
    """Possible changes of a node, as functions."""
    yield from _operators(node)
    if isinstance(node, ast.Constant):
        yield from _constants(node)
    elif isinstance(node, ast.Attribute) and node.attr in _NAMES:
        yield lambda x: setattr(x, "attr", _NAMES[x.attr])
    elif isinstance(node, ast.Call):
        if isinstance(node.func, ast.Name) and node.func.id in _NAMES:
            yield lambda x: setattr(x.func, "id", _NAMES[x.func.id])
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        plain = not any(isinstance(a, ast.Starred) for a in node.args[-2:])
        other = len(node.args) > 1 and ast.dump(node.args[-1]) != ast.dump(node.args[-2])
        if other and plain and name not in _SYMMETRIC:
            yield lambda x: x.args.__setitem__(slice(-2, None), x.args[:-3:-1])
    elif isinstance(node, ast.Return) and isinstance(node.value, ast.BinOp):
        yield lambda x: setattr(x, "value", ast.UnaryOp(ast.USub(), x.value))
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        yield lambda x: setattr(x, "test", ast.UnaryOp(ast.Not(), x.test))


def _operators(node: ast.AST) -> Iterator[Callable[[Any], None]]:
    """Another operator in the place of one."""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in _COMPARE:
        yield lambda x: x.ops.__setitem__(0, _COMPARE[type(x.ops[0])]())
    elif isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in _BINARY and not _is_text(node):
        yield lambda x: setattr(x, "op", _BINARY[type(x.op)]())
    elif isinstance(node, ast.BoolOp):
        yield lambda x: setattr(x, "op", ast.Or() if isinstance(x.op, ast.And) else ast.And())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield lambda x: setattr(x, "op", ast.UAdd())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield lambda x: setattr(x, "operand", ast.UnaryOp(ast.Not(), x.operand))


def _constants(node: ast.Constant) -> Iterator[Callable[[Any], None]]:
    value = node.value
    if isinstance(value, bool):
        yield lambda x: setattr(x, "value", not value)
    elif isinstance(value, int | float):
        yield lambda x: setattr(x, "value", value + 1 if isinstance(value, int) else 2.0 * value or 1.0)


def _is_text(node: ast.BinOp | ast.AugAssign) -> bool:
    sides = [node.left, node.right] if isinstance(node, ast.BinOp) else [node.value]
    texts = [s for s in sides if isinstance(s, ast.JoinedStr) or isinstance(getattr(s, "value", None), str)]
    return bool(texts)
