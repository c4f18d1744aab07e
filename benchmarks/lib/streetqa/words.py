"""What questions call objects: plain words, the leaves of the ontology that they mean, and leaves that look alike."""

import dataclasses
import functools

from urbanverse_mjx.assets.categories import ontology


@dataclasses.dataclass(frozen=True)
class Word:
    """A word of questions.

    Attributes:
      name, plural: as in a sentence.
      leaves: leaves that it means.
      doubtful: leaves that a reader could also call so; where one is visible, the word is not used.
      coloured: whether its objects are painted in one main colour.
    """

    name: str
    plural: str
    leaves: frozenset[str]
    doubtful: frozenset[str] = frozenset()
    coloured: bool = False


def _group(top: str, middle: str) -> frozenset[str]:
    return frozenset(leaf for leaf, row in ontology.categories().items() if tuple(row[:2]) == (top, middle))


def _word(name: str, leaves: str = "", doubtful: str = "", plural: str = "", coloured: bool = False) -> Word:
    def leaves_of(text: str) -> frozenset[str]:
        return frozenset(x.strip() for x in text.split(",") if x.strip())

    return Word(name, plural or f"{name}s", leaves_of(leaves or name), leaves_of(doubtful), coloured)


@functools.cache
def words() -> dict[str, Word]:
    """All words by their names."""
    people = _group("street user", "person")
    rows = [
        Word("person", "people", people),
        Word("dog", "dogs", frozenset({"dog"}), _group("street user", "animal") - {"dog"} | {"robot dog"}),
        _word(
            "car",
            "sedan, suv, hatchback car, taxi, convertible car, coupe car, electric car, car, sports car, limousine, "
            "police car",
            "pickup truck, minivan, van, ambulance, camper",
            coloured=True,
        ),
        _word("van", "van", "minivan, truck, camper, ambulance, suv, bus", coloured=True),
        _word("motorcycle", "motorcycle", "motorcycle rider, scooter, dirt bike, electric scooter rider"),
        _word("bicycle", "bicycle", "cyclist, bicycle parking, bicycle rental, tricycle, scooter"),
        _word("tree", "tree", "shrub, potted plant, palm tree, flower"),
        _word("potted plant", "potted plant", "plant pot, shrub, flower, tree"),
        _word("bench", "bench", "picnic table, sofa, counter", "benches"),
        _word("chair", "chair", "stool, armchair, office chair, wheelchair", coloured=True),
        _word("table", "table", "picnic table, counter, desk"),
        _word("trash bin", "trash bin", "dumpster, barrel or bucket, plant pot, waste station", coloured=True),
        _word("garbage bag", "garbage bag", "", coloured=True),
        _word("bollard", "bollard", "guard stone, pole, stone block, lamp", coloured=True),
        _word("traffic cone", "traffic cone"),
        _word("fire hydrant", "fire hydrant", "water point, bollard", coloured=True),
        _word("mailbox", "mailbox, postbox", "parcel locker, newspaper stand", "mailboxes", coloured=True),
        _word("parking meter", "parking meter", "self-service payment kiosk or terminal", coloured=True),
        _word(
            "street lamp", "street light, lamppost", "utility pole, traffic light, pole, lamp, lantern, street clock"
        ),
        _word("traffic light", "traffic light"),
        _word("vending machine", "vending machine", "self-service payment kiosk or terminal, atm", coloured=True),
        _word("newspaper stand", "newspaper stand", "advertising board, mailbox", coloured=True),
        _word("advertising board", "advertising board", "banner, bulletin board, blackboard, information point"),
        _word("bicycle rack", "bicycle parking", "guard rail, fence, bicycle rental"),
        _word("stroller", "stroller", "shopping cart, handcart, wheelchair user"),
        _word("air conditioner", "air conditioner", "transformer tower, street cabinet"),
        _word("storage box", "storage box", "parcels, container, street cabinet, luggage", "storage boxes", True),
        _word("street cabinet", "street cabinet", "control cabinets, storage box, vending machine", coloured=True),
        _word("stop sign", "stop sign"),
        _word("stool", "stool", "chair, table"),
    ]
    return {word.name: word for word in rows}


def article(name: str) -> str:
    """The word with a or an."""
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"
