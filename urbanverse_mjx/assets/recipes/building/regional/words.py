"""Words of shop signs as masks, so that signs show any script and need no font when meshes are built.

`words.npz` holds the masks: `python -m urbanverse_mjx.assets sign-words FOLDER` draws them with the Noto fonts of a
folder (Debian's packages fonts-noto-core and fonts-noto-cjk). HarfBuzz (through Pillow's Raqm) joins and orders the
letters of Arabic and Devanagari. The fonts are under the SIL Open Font License 1.1, which does not extend to what is
drawn with them.
"""

import functools
import os
import pathlib
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont, features

from urbanverse_mjx.datatypes import ValidationError, array_file

#: Height of a mask in pixels: of shop signs, and of boards.
HEIGHT, BOARD_HEIGHT = 30, 18
#: Face of `words.toml` -> font file and number of the face in it.
FACES: Mapping[str, tuple[str, int]] = {
    "sans": ("NotoSans-Bold.ttf", 0),
    "serif": ("NotoSerif-Bold.ttf", 0),
    "arabic": ("NotoNaskhArabic-Bold.ttf", 0),
    "devanagari": ("NotoSansDevanagari-Bold.ttf", 0),
    "cjk": ("NotoSansCJK-Bold.ttc", 0),
    "cjkserif": ("NotoSerifCJK-Bold.ttc", 0),
    "cjkkr": ("NotoSansCJK-Bold.ttc", 1),
    "cjksc": ("NotoSansCJK-Bold.ttc", 2),
    "cjktc": ("NotoSansCJK-Bold.ttc", 3),
    "thai": ("NotoSansThai-Bold.ttf", 0),
}
#: Faces whose words can also stand in a column, letter below letter.
UPRIGHT = ("cjk", "cjkserif", "cjkkr", "cjksc", "cjktc")
_FILE = pathlib.Path(__file__).with_suffix(".npz")
#: What boards say, and shop signs of places whose language is not that of their tradition.
BOARDS = pathlib.Path(__file__).with_name("boards.toml")


@functools.cache
def languages() -> Mapping[str, Mapping[str, tuple[str, ...]]]:
    """Language -> trade -> words."""
    return {name: {k: tuple(x) for k, x in row.items() if k != "face"} for name, row in _table().items()}


@functools.cache
def _table() -> Mapping[str, Mapping[str, str | list[str]]]:
    """The languages of traditions, and those of places that have another one than their tradition."""
    faces = board_table()["faces"]
    others = {name: {"face": faces.get(name, "sans"), **row} for name, row in board_table()["shops"].items()}
    return {**_own_table(), **others}


@functools.cache
def board_table() -> Mapping[str, Any]:
    """The table of `BOARDS`."""
    return tomllib.loads(BOARDS.read_text(encoding="utf-8"))


def _own_table() -> Mapping[str, Mapping[str, str | list[str]]]:
    return tomllib.loads(pathlib.Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def lines(words: str) -> list[str]:
    """The lines of an entry of the table."""
    return [line.strip() for line in words.split("|")]


@functools.cache
def _masks() -> Mapping[str, np.ndarray]:
    data = array_file.load(_FILE, "the words of signs", "copy the file again")
    bits, found, at = np.unpackbits(data["bits"]), {}, 0
    names = data["names"].tobytes().decode("utf-8").split("\n")
    for name, (height, width) in zip(names, data["sizes"].tolist(), strict=True):
        found[name] = bits[at : at + height * width].reshape(height, width) * np.uint8(255)
        at += height * width
    return found


def mask(language: str, line: str, upright: bool = False) -> Image.Image:
    """A line's ink as a gray image (255 = ink) without margins; `upright` stacks its letters.

    Raises:
      ValidationError: the line is not in the table, or its script is not written in columns.
    """
    key = f"{language}/{line}{'/upright' if upright else ''}"
    if key not in _masks():
        raise ValidationError(f"word of a sign: found {key!r}, needed one of {_FILE.name}; draw it with `sign-words`.")
    return Image.fromarray(_masks()[key], "L")


def can_stand(language: str) -> bool:
    """Whether the words of a language can stand in a column."""
    return _table()[language]["face"] in UPRIGHT


def draw_words(fonts: str | os.PathLike[str]) -> pathlib.Path:
    """Draws the words of the tables that `words.npz` lacks with the fonts below a folder, and writes it.

    Those that it has stay as they are, so that other versions of the fonts change no sign.

    Raises:
      ValidationError: a font is missing, or Pillow cannot join letters.
    """
    if not features.check("raqm"):
        raise ValidationError("Pillow: found no Raqm, needed it for joined letters; install Pillow's binary wheel.")
    files = {path.name: path for path in sorted(pathlib.Path(fonts).rglob("Noto*"))}
    known = dict(_masks()) if _FILE.is_file() else {}
    masks: dict[str, np.ndarray] = {}

    def draw(language: str, face: str, lines_of: list[str], height: int = HEIGHT) -> None:
        name, number = FACES[face]
        if name not in files:
            raise ValidationError(f"{fonts}: found no {name}, needed it for the words in {language}; unpack it there.")
        font = ImageFont.truetype(str(files[name]), 2 * HEIGHT, number, layout_engine=ImageFont.Layout.RAQM)
        latin = ImageFont.truetype(str(files[FACES["sans"][0]]), 2 * HEIGHT, layout_engine=ImageFont.Layout.RAQM)
        for line in lines_of:
            key = f"{language}/{line}"
            pen = latin if _is_latin(line) and face not in ("sans", "serif") else font
            masks[key] = known[key] if key in known else _drawn(line, pen, height)
            if face in UPRIGHT and not _is_latin(line) and height == HEIGHT:
                key = f"{key}/upright"
                masks[key] = known[key] if key in known else _column(line.replace(" ", ""), font)

    for language, row in _table().items():
        entries = [w for trade, found in row.items() if trade != "face" for w in found]
        draw(language, str(row["face"]), [line for words in entries for line in lines(words)])
    table = board_table()
    for column, language in enumerate(table["columns"]):
        entries = [row[column] for row in table["texts"].values()]
        face = table["faces"].get(language, "sans")
        draw(f"boards/{language}", face, [x for words in entries for x in lines(words)], BOARD_HEIGHT)
    names = sorted(masks)
    arrays = {
        "names": np.frombuffer("\n".join(names).encode("utf-8"), np.uint8),
        "sizes": np.array([masks[name].shape for name in names], np.int32),
        "bits": np.packbits(np.concatenate([masks[name].ravel() > 0 for name in names])),
    }
    array_file.save(_FILE, arrays)
    return _FILE


def _is_latin(line: str) -> bool:
    return ord(line[0]) < 0x250


def _drawn(line: str, font: ImageFont.FreeTypeFont, height: int = HEIGHT) -> np.ndarray:
    """A line of the given height, (height, w) uint8 of 0 and 255, cut to its ink."""
    left, top, right, bottom = font.getbbox(line)
    image = Image.new("L", (int(right - left) + 8, int(bottom - top) + 8), 0)
    ImageDraw.Draw(image).text((4 - left, 4 - top), line, 255, font)
    image = image.crop(image.getbbox())
    width = max(1, round(image.width * height / image.height))
    return (np.asarray(image.resize((width, height), Image.Resampling.LANCZOS)) > 127).astype(np.uint8) * 255


def _column(line: str, font: ImageFont.FreeTypeFont) -> np.ndarray:
    """Letters below each other, each in a square cell of `HEIGHT` pixels; long vowel signs are turned."""
    cells = []
    for letter in line:
        cell = Image.new("L", (2 * HEIGHT, 2 * HEIGHT), 0)
        left, top, right, bottom = font.getbbox(letter)
        at = (HEIGHT - (left + right) / 2, HEIGHT - (top + bottom) / 2)
        ImageDraw.Draw(cell).text(at, letter, 255, font)
        cell = cell.transpose(Image.Transpose.ROTATE_270) if letter == "ー" else cell
        cells.append(np.asarray(cell.resize((HEIGHT, HEIGHT), Image.Resampling.LANCZOS)) > 127)
    return np.concatenate(cells).astype(np.uint8) * 255
