"""Sizes and variants of the objects of hand-made scenes.

Each row is (along the heading, across, up) in metres; several rows are variants of a label, such as an upright and a
collapsed bag. The sizes are the boxes of the base assets, so that materialisation stretches no asset. Each new object
takes the label's next size unless `variant` names one.
"""

from ...datatypes.toml_table import table
from ..catalogue import TREES, Size

#: A kick scooter stands or lies on its side. A graph's objects rotate about z alone, so a fallen one has a different
#: box, as broad as long and half as high; the asset with the fitting box is a scooter on its side.
SCOOTER_STANDING, SCOOTER_FALLEN = 0, 1

SIZES: dict[str, tuple[Size, ...]] = {
    "scooter": ((1.14, 0.54, 1.18), (1.14, 1.19, 0.54)),
    "tree": tuple(TREES.values()),
    **table(__file__),
}
