"""Base of datatypes whose file form is one JSON object."""

import abc
import os
from typing import Any, ClassVar, Self

from . import validation as v
from .hashing import content_hash


class JsonDatatype(abc.ABC):
    """A datatype that is a JSON object in a file.

    Attributes:
      KIND: its name, for sentences about files.
    """

    KIND: ClassVar[str]

    @abc.abstractmethod
    def to_json(self) -> dict[str, Any]: ...

    @classmethod
    @abc.abstractmethod
    def from_json(cls, value: Any) -> Self: ...

    def content_hash(self) -> str:
        """Hash over the canonical content (see `hashing`)."""
        return content_hash(self.to_json())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the file."""
        v.write_json(path, self.to_json())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Reads a file.

        Raises:
          ValidationError: no such file, or invalid contents.
        """
        return cls.from_json(v.read_json(path, cls.KIND))
