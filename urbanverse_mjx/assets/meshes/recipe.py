"""The register of recipes: leaf category -> function that builds its variants, with the physical priors of the leaf.

A recipe is `f(variant, rng) -> BuiltAsset`. `rng` is seeded from recipe, leaf and variant alone, so a record rebuilds
the same mesh anywhere. Modules under `assets.recipes` are imported when the register is first asked.
"""

import dataclasses
import functools
import hashlib
import importlib
import pkgutil
from collections.abc import Callable

import numpy as np

from urbanverse_mjx.datatypes import ValidationError

from ..categories import ontology
from .mesh_builder import BuiltAsset

RecipeFunction = Callable[[int, np.random.Generator], BuiltAsset]


@dataclasses.dataclass(frozen=True)
class Physics:
    """Physical priors of a leaf.

    Attributes:
      materials: dominant materials, most first.
      density: kg per m^3 of the mesh's enclosed volume, air inside counted (a hollow steel box is 200-500).
      mass_range: kg, (least, greatest) that the product of volume and density is clipped to.
      friction: sliding friction coefficient of its surface.
      movable: whether one person could shift it (bolted-down objects are not, however light).
      reason: where these values come from, or why they are plausible.
    """

    materials: tuple[str, ...]
    density: float
    mass_range: tuple[float, float]
    friction: float
    movable: bool
    reason: str


@dataclasses.dataclass(frozen=True)
class Recipe:
    """One registered recipe.

    Attributes:
      name: frozen; independent of the function's name and module.
      physics: None takes mass, matter and friction from the leaf's row of `assets_index/priors.csv`.
      hulls: caps the convex decomposition (None: chosen by size).
    """

    name: str
    leaf: str
    variants: int
    physics: Physics | None
    function: RecipeFunction
    hulls: int | None = None

    def build(self, variant: int) -> BuiltAsset:
        """Builds one variant, 0 <= variant; the same one every time."""
        seed = hashlib.sha256(f"{self.name}/{self.leaf}/{variant}".encode()).digest()
        return self.function(variant, np.random.default_rng(int.from_bytes(seed[:8], "little")))


_REGISTER: dict[tuple[str, str], Recipe] = {}


def recipe(
    leaf: str, variants: int, physics: Physics | None = None, hulls: int | None = None, *, name: str
) -> Callable[[RecipeFunction], RecipeFunction]:
    """Decorator: registers the function for an ontology leaf. One function may serve several leaves (stack decorators).

    Args:
      leaf: exact leaf name of the ontology.
      name: part of every variant's uid and seed, so it stays as it is when the function or its file is renamed; unique
        for the leaf.
      variants: how many the index holds.
      physics: the recipe's own physical priors; None takes those of the leaf's row of `assets_index/priors.csv`.
      hulls: most convex hulls of the decomposition, 1 to 16; None lets the asset's size decide; 1 means its convex
      hull.

    Raises:
      ValidationError: no such leaf, or the recipe is already registered for it.
    """
    ontology.category_of(leaf)

    def register(function: RecipeFunction) -> RecipeFunction:
        if (name, leaf) in _REGISTER:
            raise ValidationError(
                f"recipe {name!r}: found it registered twice for {leaf!r}, needed one; give one another name."
            )
        _REGISTER[name, leaf] = Recipe(name, leaf, variants, physics, function, hulls)
        return function

    return register


@functools.cache
def _load_all() -> None:
    package = importlib.import_module("urbanverse_mjx.assets.recipes")
    for module in sorted(m.name for m in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")):
        importlib.import_module(module)


def all_recipes() -> list[Recipe]:
    """Every registered recipe, by leaf and name."""
    _load_all()
    return sorted(_REGISTER.values(), key=lambda r: (r.leaf, r.name))


def get_recipe(name: str, leaf: str) -> Recipe:
    """The recipe that an index record names.

    Raises:
      ValidationError: it does not exist in this version of the package.
    """
    _load_all()
    if (name, leaf) not in _REGISTER:
        raise ValidationError(
            f"asset recipe: found {name!r} for {leaf!r} in the index, needed one of this package's recipes; "
            "rebuild the index with `python -m urbanverse_mjx.assets index`."
        )
    return _REGISTER[name, leaf]
