"""What modules hold when they are imported: constants, defaults of functions and of records."""

import ast
import dataclasses
import importlib
import inspect
import pkgutil
from collections.abc import Iterator, Mapping
from typing import Any, TypeGuard

import numpy as np

import urbanverse_mjx


def modules_of(package: str) -> list[str]:
    """Dotted names of the modules of a package, such as "scene", and of those below it."""
    name = f"{urbanverse_mjx.__name__}.{package}"
    top = importlib.import_module(name)
    return sorted([name, *(info.name for info in pkgutil.walk_packages(top.__path__, f"{name}."))])


def defaults_of(module: str) -> dict[str, np.ndarray]:
    """Name -> the numbers in it, in order: the module's own constants, and defaults of its functions, methods and
    fields."""
    found = importlib.import_module(module)
    own = _assigned(inspect.getsource(found))
    values: dict[str, Any] = {}
    for name, value in vars(found).items():
        if inspect.isclass(value):
            if value.__module__ == module:
                values |= {f"{name}.{key}": x for key, x in _of_class(value)}
        elif callable(value):
            if getattr(value, "__module__", None) == module:
                values |= {f"{name}({key})": x for key, x in _of_function(value)}
        elif name in own:
            values[name] = value
    return {name: np.array(_numbers(value), np.float64) for name, value in values.items() if _plain(value)}


def _assigned(source: str) -> set[str]:
    """Names that a module binds itself."""
    found = set[str]()
    for node in ast.parse(source).body:
        targets = node.targets if isinstance(node, ast.Assign) else [node.target] if _annotated(node) else []
        found |= {n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)}
    return found


def _annotated(node: ast.stmt) -> TypeGuard[ast.AnnAssign | ast.AugAssign]:
    return isinstance(node, ast.AnnAssign | ast.AugAssign)


def _of_class(of: type) -> Iterator[tuple[str, Any]]:
    for name, value in vars(of).items():
        if inspect.isfunction(value):
            yield from ((f"{name}({key})", x) for key, x in _of_function(value) if name != "__init__")
        elif not name.startswith("_") and not callable(value) and not hasattr(value, "__get__"):
            yield name, value
    if dataclasses.is_dataclass(of):
        for field in dataclasses.fields(of):
            if field.default_factory is not dataclasses.MISSING:
                yield field.name, field.default_factory()


def _of_function(function: Any) -> Iterator[tuple[str, Any]]:
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return
    yield from ((p.name, p.default) for p in parameters if p.default is not inspect.Parameter.empty)


def _plain(value: Any) -> bool:
    """Whether a value has a number and holds nothing but numbers and text."""
    items = list(_items(value))
    return any(not isinstance(x, str) for x in items) and all(
        isinstance(x, bool | int | float | str) or (isinstance(x, np.ndarray | np.generic) and x.dtype.kind in "biuf")
        for x in items
    )


def _numbers(value: Any) -> list[float]:
    arrays = [np.ravel(np.asarray(x)) for x in _items(value) if not isinstance(x, str)]
    return np.concatenate(arrays).tolist()


def _items(value: Any) -> Iterator[Any]:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        value = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        yield from (x for key, item in value.items() for x in (str(key), *_items(item)))
    elif isinstance(value, list | tuple | set | frozenset):
        yield from (x for item in value for x in _items(item))
    elif value is not None:
        yield value
