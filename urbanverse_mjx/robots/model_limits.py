"""Checks the size of a robot's model before MuJoCo compiles it, because a small MJCF can require all memory.

It counts elements including those made by `replicate`, `composite` and `flexcomp`, and the sizes of images and height
fields, in the file and in included files.
"""

import contextlib
import math
import pathlib
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from ..datatypes import validation as v

#: Largest number of elements of a robot; the Go2 has 100.
MAX_ELEMENTS = 20_000
#: Largest number of pixels of a texture and of points of a height field.
MAX_PIXELS = 64 * 10**6
_MAX_DEPTH = 20
_PNG = b"\x89PNG\r\n\x1a\n"
#: Elements that make others -> the attribute with their number.
_COUNTS = {"replicate": "count", "composite": "count", "flexcomp": "count"}
#: Elements with as many values as the product of these attributes.
_GRIDS = {"hfield": ("nrow", "ncol"), "texture": ("width", "height")}


def check_size(path: pathlib.Path, where: str) -> None:
    """Checks that an MJCF does not exceed the limits.

    Args:
      path: an existing file; MuJoCo reports one that is not XML.
      where: field that names the file, for messages.

    Raises:
      ValidationError: the MJCF exceeds a limit, or includes itself.
    """
    if (elements := _elements(path, where, 0)) > MAX_ELEMENTS:
        raise v.fail(where, f"{path}, which makes {elements} elements", f"at most {MAX_ELEMENTS}", "simplify the robot")


def _elements(path: pathlib.Path, where: str, depth: int) -> int:
    """Number of elements that a file makes."""
    if depth > _MAX_DEPTH:
        raise v.fail(where, f"{path}, included {depth} files deep", f"at most {_MAX_DEPTH}", "does it include itself?")
    try:
        root = ET.parse(path).getroot()
    except (ET.ParseError, OSError, ValueError):
        return 0
    total = 0
    folders = {
        path.parent / x.get(key, "") for x in root.iter("compiler") for key in ("assetdir", "texturedir", "meshdir")
    }
    for element, times in _all_below(root, 1):
        _check_grid(element, path, where)
        _check_images(element, {path.parent, *folders}, where)
        total += times
        if element.tag == "include" and total <= MAX_ELEMENTS:
            total += times * _elements(path.parent / element.get("file", ""), where, depth + 1)
    return total


def _all_below(root: ET.Element, times: int) -> Iterator[tuple[ET.Element, int]]:
    """Yields every element and its multiplicity. Iterative, because a file may be nested deeper than Python's stack."""
    waiting = [(root, times)]
    while waiting:
        element, times = waiting.pop()
        yield element, times
        inside = times * (_product(element.get(_COUNTS[element.tag], "1")) if element.tag in _COUNTS else 1)
        if element.tag in _COUNTS and not len(element):
            yield element, inside
        waiting += [(child, inside) for child in element]


def _check_grid(element: ET.Element, path: pathlib.Path, where: str) -> None:
    names = _GRIDS.get(element.tag, ())
    size = _product(" ".join(element.get(name, "1") for name in names))
    if size > MAX_PIXELS:
        shown = " x ".join(element.get(name, "1") for name in names)
        raise v.fail(where, f"{path} with a {element.tag} of {shown}", f"at most {MAX_PIXELS}", "make it coarser")


def _check_images(element: ET.Element, folders: set[pathlib.Path], where: str) -> None:
    """Checks the number of pixels of the PNG files of an element."""
    for key, name in element.items():
        for folder in folders if key.startswith("file") and name.lower().endswith(".png") else ():
            with contextlib.suppress(OSError), (folder / name).open("rb") as file:
                head = file.read(24)
                width, height = (int.from_bytes(head[k : k + 4]) for k in (16, 20))
                if head.startswith(_PNG) and width * height > MAX_PIXELS:
                    found = f"{folder / name} of {width} x {height} pixels"
                    raise v.fail(where, found, f"at most {MAX_PIXELS}", "scale it down")


def _product(text: str) -> int:
    """The product of numbers in a text; 1 for an invalid number, which MuJoCo refuses itself."""
    try:
        return math.prod(max(int(float(part)), 1) for part in text.split())
    except (ValueError, OverflowError):
        return 1
