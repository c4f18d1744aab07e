"""How large the objects of hand-made scenes are, and in which variants they come.

(along the heading, across, up) in metres; several rows are several variants of a label: a bag that stands, one that has
spread. They are the boxes of the base assets, so that materialisation stretches no asset; an object comes in the next
size each time unless `variant` names one.
"""

from ...datatypes.toml_table import table
from ..catalogue import TREES, Size

#: A kick scooter stands or lies on its side. A graph's objects rotate about z alone: a fallen one has another box, as
#: broad as long and half as high, and the asset whose box fits is a scooter on its side.
SCOOTER_STANDING, SCOOTER_FALLEN = 0, 1

SIZES: dict[str, tuple[Size, ...]] = {
    "scooter": ((1.14, 0.54, 1.18), (1.14, 1.19, 0.54)),
    "tree": tuple(TREES.values()),
    **table(__file__),
}
