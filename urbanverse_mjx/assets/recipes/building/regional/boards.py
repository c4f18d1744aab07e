"""Texts of boards, vehicles and counters in the language of a street (`boards.toml`).

Recipes write English with `paint.text`. Within `in_language`, known texts are drawn from masks of `words.npz` instead,
and shop signs of regional houses are those of the language where `boards.toml` has some.
"""

import contextlib
import contextvars
import functools
import hashlib
import re
from collections.abc import Iterator

from PIL import Image

from ....meshes import paint
from . import words
from .styles import traditions

#: The language of streets whose texts stay as recipes write them, but for those in other languages.
ENGLISH = "english"
_SPOKEN: contextvars.ContextVar[str] = contextvars.ContextVar("spoken", default="")


@functools.cache
def stamp() -> str:
    """Digest of the table, for keys of caches."""
    return hashlib.sha256(words.BOARDS.read_bytes()).hexdigest()[:12]


def language_of(place: tuple[str, str]) -> str:
    """The language of the boards of a (city, country)."""
    rows = words.board_table()["places"]
    return next((name for part in place for name, places in rows.items() if part in places), ENGLISH)


def spoken() -> str:
    """The language within which this is called; "" outside of `in_language`."""
    return _SPOKEN.get()


def shop_language(own: str) -> str:
    """The language of shop signs whose tradition has `own`."""
    return spoken() if spoken() in words.board_table()["shops"] else own


def key_of(text: str) -> str:
    """The text as `boards.toml` has it: upper case, in one line, without arrows and numbers around it."""
    line = " ".join(text.upper().split()).strip("<> ")
    if re.fullmatch(r"(\w )+\w", line):  # letters below each other
        line = line.replace(" ", "")
    return re.sub(r" \d[\d.]*$", "", re.sub(r"^\d+ (?=\D)", "", line))


def translated(text: str, language: str) -> str | None:
    """A text in a language, its lines parted by "|"; None for one that stays as it is."""
    rows = words.board_table()
    if language == ENGLISH:
        return rows["english"].get(key_of(text))
    found = rows["texts"].get(key_of(text))
    return None if found is None else found[rows["columns"].index(language)]


@contextlib.contextmanager
def in_language(language: str) -> Iterator[None]:
    """Draws known texts in a language within the context; "" draws all as recipes write them."""
    if not language:
        yield
        return

    def masks(text: str) -> list[Image.Image] | str | None:
        found = translated(text, language)
        if found is None or language == ENGLISH:
            return found
        return [words.mask(f"boards/{language}", line) for line in words.lines(found)]

    token = _SPOKEN.set(language)
    try:
        with paint.translating(masks):
            yield
    finally:
        _SPOKEN.reset(token)


def is_lettered(recipe: str, leaf: str) -> bool:
    """Whether a recipe's mesh of a leaf looks different in the language that is spoken."""
    if not spoken():
        return False
    if recipe.startswith("regional."):
        own = traditions()[recipe.removeprefix("regional.")].language
        return shop_language(own) != own
    return leaf in words.board_table()["lettered"]["leaves"]
