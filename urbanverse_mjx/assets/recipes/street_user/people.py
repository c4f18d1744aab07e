"""People on foot."""

import dataclasses

import numpy as np

from ...meshes import paint
from ...meshes.mesh_builder import BuiltAsset, MeshBuilder
from ...meshes.palette import Color
from ...meshes.recipe import Physics, recipe
from .figure import RUNNING, STANDING, WALKING, WALKING_OTHER, Figure, Person, Pose
from .worn_items import backpack, cap, carried_bag, shoulder_bag, vest

_REASON = (
    "body masses of the age group; a person is no load to be shoved about, so not movable; clothes slide at about 0.5"
)


ADULT = Physics(("flesh", "fabric"), 985.0, (48.0, 110.0), 0.5, False, _REASON)


CHILD = Physics(("flesh", "fabric"), 985.0, (14.0, 48.0), 0.5, False, _REASON)


def _mass(person: Person) -> float:
    """Body mass from a body mass index of 23 at girth 1 (16 for children), kg."""
    index = 23.0 if person.height > 1.5 else 16.5
    return round(index * person.height**2 * person.girth, 1)


def _done(figure: Figure, description: str, params: dict, extra_mass: float = 0.0) -> BuiltAsset:
    built = figure.builder.build(description, params, mass=_mass(figure.person) + extra_mass)
    return dataclasses.replace(built, volume=_mass(figure.person) / 985.0)


def _figure(person: Person, pose: Pose) -> Figure:
    figure = Figure(MeshBuilder(roughness=0.85), person, pose)
    figure.build()
    return figure


_ADULTS = (
    (
        "A woman in a red coat, walking with a handbag",
        Person(1.68, 0.95, "skin light", "long", "#5a3820", "coat", "#a32630", "trousers", "charcoal", "#3a2a22"),
        WALKING,
    ),
    (
        "A man in a blue shirt and jeans with a backpack, walking",
        Person(1.80, 1.05, "skin medium", "short", "#1e1612", "shirt", "#4a7fb5", "trousers", "#2d3a55", "white"),
        WALKING_OTHER,
    ),
    (
        "A man in a grey suit, standing",
        Person(1.78, 1.0, "skin dark", "short", "#15100d", "jacket", "#5d636b", "trousers", "#4c5158", "black"),
        STANDING,
    ),
    (
        "A woman in a yellow dress, walking",
        Person(1.65, 0.98, "skin dark", "curly", "#1b120e", "dress", "#e0b23c", "skirt", "#e0b23c", "white", "short"),
        WALKING_OTHER,
    ),
    (
        "A young man in a green hooded jacket, standing with a phone",
        Person(1.76, 0.95, "skin light", "short", "#b88a4a", "jacket", "#4f6b4a", "trousers", "#76695a", "#c9c4ba"),
        Pose((3, -3), (4, 4), (8, 22), (14, 88), 4.0),
    ),
    (
        "A woman in a white blouse and dark skirt with shopping bags",
        Person(1.66, 1.1, "skin medium", "bun", "#2b1d15", "shirt", "#ece8df", "skirt", "#2e3350", "black"),
        WALKING,
    ),
)


@recipe("pedestrian adult", 6, ADULT, hulls=3, name="people.pedestrian_adult")
def pedestrian_adult(variant: int, rng: np.random.Generator) -> BuiltAsset:
    description, person, pose = _ADULTS[variant]
    figure = _figure(person, pose)
    if variant == 0:
        shoulder_bag(figure, "#6d4a2c")
    elif variant == 1:
        backpack(figure, "#3c4a3a")
    elif variant == 2:
        carried_bag(figure, 1, "#3a2a1e", (0.38, 0.10, 0.28))
    elif variant == 4:
        figure.builder.box(
            (0.012, 0.07, 0.14),
            tuple(figure.hands[1] + [0.03, 0.02, 0.03]),
            "black",
            turn_deg=(0, -30, 0),
            centered=True,
        )
    elif variant == 5:
        carried_bag(figure, 0, "white")
        carried_bag(figure, 1, "#c46a8a")
    return _done(
        figure, description, {"height": person.height, "pose": "standing" if variant in (2, 4) else "walking"}, 3.0
    )


@recipe("pedestrian child", 4, CHILD, hulls=2, name="people.pedestrian_child")
def pedestrian_child(variant: int, rng: np.random.Generator) -> BuiltAsset:
    description, person, pose = (
        (
            "A girl in a pink dress, walking",
            Person(
                1.18, 0.95, "skin light", "long", "#8a5a30", "dress", "pink", "skirt", "pink", "white", "short", 1.28
            ),
            WALKING,
        ),
        (
            "A boy in a striped shirt and shorts with a school bag",
            Person(
                1.26, 0.98, "skin medium", "short", "#2a1c14", "shirt", "orange", "shorts", "blue", "red", "short", 1.24
            ),
            WALKING_OTHER,
        ),
        (
            "A toddler in a yellow raincoat, standing",
            Person(
                0.95,
                1.12,
                "skin light",
                "short",
                "#c79a5a",
                "coat",
                "signal yellow",
                "trousers",
                "dark blue",
                "red",
                "long",
                1.42,
            ),
            STANDING,
        ),
        (
            "A girl in a teal jacket, standing",
            Person(
                1.36,
                0.95,
                "skin dark",
                "curly",
                "#17100c",
                "jacket",
                "teal",
                "trousers",
                "#3c3f55",
                "white",
                "long",
                1.18,
            ),
            STANDING,
        ),
    )[variant]
    figure = _figure(person, pose)
    if variant == 1:
        backpack(figure, "red", 1.15)
    if variant == 2:
        cap(figure, "signal yellow", "beanie")
    return _done(figure, description, {"height": person.height}, 1.0)


@recipe("elderly person", 3, ADULT, hulls=3, name="people.elderly_person")
def elderly_person(variant: int, rng: np.random.Generator) -> BuiltAsset:
    bent = Pose((9, -6), (12, 16), (10, 34), (18, 34), 14.0)
    description, person, pose = (
        (
            "An old man with a walking stick and a flat cap",
            Person(1.68, 1.05, "skin light", "bald", "#d8d8d4", "jacket", "#7a6a50", "trousers", "#55504a", "#3a2a1e"),
            bent,
        ),
        (
            "An old woman with white hair and a handbag",
            Person(1.57, 1.12, "skin light", "bun", "#e4e2de", "coat", "#6a5a7a", "skirt", "#4a4252", "#2e2622"),
            dataclasses.replace(bent, shoulder=(8, 6), lean=11.0),
        ),
        (
            "An old woman pushing a wheeled walker",
            Person(
                1.58, 1.05, "skin medium", "short", "#c9c7c2", "jacket", "#4f7a7a", "trousers", "#5a5560", "#3a3a3a"
            ),
            Pose((14, -8), (12, 18), (24, 24), (36, 36), 16.0),
        ),
    )[variant]
    figure = _figure(person, pose)
    b = figure.builder
    if variant == 0:
        x, y, z = figure.hands[1]
        b.tube(
            [(x - 0.05, y, z + 0.01), (x + 0.04, y, z + 0.03), (x + 0.06, y, z), (x + 0.10, y, 0.0)],
            0.012,
            "dark wood",
            sides=6,
        )
        cap(figure, "#5d5346", "cap")
    elif variant == 1:
        carried_bag(figure, 0, "#54301f", (0.28, 0.10, 0.20))
    else:
        for k in (0, 1):
            x, y, z = figure.hands[k]
            b.tube(
                [(x - 0.06, y, z), (x + 0.06, y, z), (x + 0.10, y, z - 0.15), (x + 0.34, y * 1.12, 0.10)],
                0.014,
                "aluminium",
                sides=6,
            )
            b.rod((x + 0.14, y, z - 0.3), (x - 0.16, y * 1.12, 0.10), 0.014, "aluminium", sides=6)
            for dx in (0.34, -0.16):
                b.ring(0.075, 0.022, (x + dx, y * 1.12, 0.097), "rubber", (90, 0, 0), 12, 6)
        x, _, z = figure.hands[0]
        b.box((0.24, 0.34, 0.03), (x + 0.13, 0, z - 0.36), "black")
    return _done(figure, description, {"height": person.height}, 2.0)


@recipe("construction worker", 3, ADULT, hulls=3, name="people.construction_worker")
def construction_worker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    description, person, pose, hat = (
        (
            "A construction worker in an orange vest and yellow helmet, walking",
            Person(1.80, 1.1, "skin light", "short", "#3a2a1e", "shirt", "#3c4f78", "trousers", "#3a4048", "#6b4a2a"),
            WALKING,
            "signal yellow",
        ),
        (
            "A construction worker in a lime vest with a white helmet and plans",
            Person(1.74, 1.0, "skin medium", "short", "#1e1612", "jacket", "#6a6f78", "trousers", "#5a4f42", "#4a3624"),
            Pose((2, -2), (3, 3), (12, 22), (60, 74), 2.0),
            "white",
        ),
        (
            "A road worker in orange with a shovel",
            Person(
                1.77,
                1.15,
                "skin dark",
                "bald",
                "#120d0a",
                "shirt",
                "safety orange",
                "trousers",
                "safety orange",
                "#3a2a1e",
            ),
            Pose((8, -6), (6, 8), (30, 12), (40, 30), 8.0),
            "safety orange",
        ),
    )[variant]
    figure = _figure(person, pose)
    vest(
        figure,
        ("safety orange", "lime", "safety orange")[variant],
        ("signal yellow", "light grey", "light grey")[variant],
    )
    cap(figure, hat, "helmet")
    if variant == 1:
        a, b = figure.hands
        figure.builder.tube([a - [0, 0.05, 0], b + [0, 0.05, 0.05]], 0.035, "white", sides=8)
    if variant == 2:
        x, y, z = figure.hands[0]
        figure.builder.rod((x - 0.12, y, z + 0.35), (x + 0.22, y, 0.32), 0.018, "light wood", sides=6)
        figure.builder.box((0.02, 0.22, 0.32), (x + 0.27, y, 0.0), "dark grey", turn_deg=(0, -14, 0))
    return _done(figure, description, {"height": person.height}, 5.0)


@recipe("police officer", 3, ADULT, hulls=3, name="people.police_officer")
def police_officer(variant: int, rng: np.random.Generator) -> BuiltAsset:
    color, trousers = (("#1e2a48", "#1a2238"), ("#9db6d0", "#1d2740"), ("#23262c", "#23262c"))[variant]
    person = Person(
        (1.82, 1.70, 1.78)[variant],
        (1.05, 0.98, 1.1)[variant],
        ("skin light", "skin dark", "skin medium")[variant],
        ("short", "bun", "short")[variant],
        ("#5a4028", "#15100d", "#1d1512")[variant],
        ("jacket", "shirt", "shirt")[variant],
        color,
        "trousers",
        trousers,
        "black",
    )
    figure = _figure(person, (STANDING, WALKING, Pose((2, -2), (3, 3), (-6, -6), (62, 62), 0.0, (26, 26)))[variant])
    cap(figure, trousers, "police" if variant < 2 else "cap")
    if variant == 2:
        vest(figure, "#2d3138", "#2d3138")
    b, h = figure.builder, person.height
    b.loft([figure.ring(0.030, 0.099, 0.072), figure.ring(0.052, 0.097, 0.071)], "black", crease_deg=60)
    for y, w in ((0.095, 0.05), (-0.095, 0.06), (0.06, 0.04)):
        at = figure.trunk(0.02) + [0.01, y * h, -0.02]
        b.box((0.06, w, 0.11), tuple(at), "black", bevel=0.01, centered=True)
    badge = figure.trunk(0.225) + [0.077 * h * person.girth, 0.045 * h, 0]
    b.box((0.008, 0.05, 0.06), tuple(badge), "gold", bevel=0.003, centered=True)
    image = _word("POLICE", "white" if variant != 1 else "#1d2740", color if variant < 2 else "#2d3138")
    back = figure.trunk(0.235) - [(0.078 if variant != 2 else 0.082) * h * person.girth, 0, 0]
    b.panel(image, tuple(back), 0.26, 0.065, "-x")
    names = (
        "A police officer in a dark uniform, standing",
        "A police officer in a light blue shirt, walking",
        "A police officer in a vest with hands on the hips",
    )
    return _done(figure, names[variant], {"height": h}, 6.0)


def _word(words: str, ink: Color, back: Color) -> np.ndarray:
    image, pen = paint.canvas((192, 48), back)
    paint.text(pen, words, (6, 4, 186, 44), ink, 0.03)
    return np.asarray(paint.shrunk(image, (64, 16)))


@recipe("jogger", 3, ADULT, hulls=3, name="people.jogger")
def jogger(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person = (
        Person(1.69, 0.9, "skin light", "bun", "#7a4a24", "shirt", "#e0507a", "trousers", "black", "lime", "short"),
        Person(1.81, 0.95, "skin dark", "short", "#15100d", "shirt", "lime", "shorts", "black", "orange", "short"),
        Person(1.75, 1.1, "skin medium", "short", "#3a2a1e", "jacket", "signal blue", "shorts", "charcoal", "white"),
    )[variant]
    pose = (
        RUNNING,
        Pose((-20, 52), (74, 58), (40, -44), (92, 86), 12.0),
        Pose((38, -14), (48, 60), (-34, 30), (80, 84), 9.0),
    )[variant]
    figure = _figure(person, pose)
    if variant == 2:
        cap(figure, "white", "cap")
    names = (
        "A woman jogging in a pink top",
        "A man running in a lime shirt and shorts",
        "A man jogging in a blue jacket and a cap",
    )
    return _done(figure, names[variant], {"height": person.height})


@recipe("delivery worker", 3, ADULT, hulls=3, name="people.delivery_worker")
def delivery_worker(variant: int, rng: np.random.Generator) -> BuiltAsset:
    person, pose = (
        (
            Person(1.78, 1.0, "skin medium", "short", "#1e1612", "jacket", "#7a4a22", "trousers", "#5a3a1e", "black"),
            Pose((20, -12), (8, 20), (34, 34), (72, 72), -3.0),
        ),
        (Person(1.75, 0.95, "skin dark", "short", "#15100d", "jacket", "teal", "trousers", "black", "white"), WALKING),
        (
            Person(
                1.72, 1.05, "skin light", "short", "#6a4526", "shirt", "red", "shorts", "charcoal", "black", "short"
            ),
            Pose((4, -3), (4, 4), (30, 30), (62, 62), -2.0),
        ),
    )[variant]
    figure = _figure(person, pose)
    cap(figure, ("#7a4a22", "teal", "red")[variant], "cap")
    middle = (figure.hands[0] + figure.hands[1]) / 2
    if variant == 0:
        figure.builder.box((0.36, 0.40, 0.30), tuple(middle + [0.06, 0, -0.06]), "cardboard", bevel=0.01)
        figure.builder.box((0.364, 0.06, 0.304), tuple(middle + [0.06, 0, -0.062]), "beige")
    elif variant == 1:  # the big insulated cube of food couriers
        h = person.height
        at = figure.trunk(0.21)
        skin = _word("FOOD GO", "white", "teal")
        with figure.builder.frame((at[0] - 0.30, 0, at[2] - 0.24), (0, pose.lean, 0)):
            figure.builder.box((0.40, 0.44, 0.46), color="teal", bevel=0.03)
            figure.builder.box((0.404, 0.444, 0.03), (0, 0, 0.36), "lime")
            figure.builder.panel(skin, (-0.203, 0, 0.2), 0.36, 0.09, "-x")
        for side in (-1, 1):
            y = side * 0.058 * h
            points = [
                figure.trunk(z) + [d * h, y, 0]
                for z, d in ((0.285, -0.06), (0.315, 0.0), (0.27, 0.072), (0.17, 0.074), (0.13, 0.02))
            ]
            figure.builder.tube(points, 0.02, "black", sides=5)
    else:
        for k, tall in enumerate((0.05, 0.05, 0.05)):
            figure.builder.box(
                (0.36, 0.36, tall - 0.006),
                tuple(middle + [0.08, 0, -0.02 + 0.05 * k]),
                ("off white", "cardboard", "off white")[k],
                bevel=0.004,
            )
    names = (
        "A parcel courier carrying a box",
        "A food courier with a cube backpack",
        "A pizza courier with three boxes",
    )
    return _done(figure, names[variant], {"height": person.height}, (8.0, 7.0, 3.0)[variant])
