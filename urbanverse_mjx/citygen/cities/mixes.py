"""Mixes that several cities share."""

from .profile import mix as m

WALKERS = m(
    "pedestrian adult 10, elderly person 1.5, pedestrian child 1.5, delivery worker 0.5, dog 0.6, stroller 0.4, "
    "jogger 0.3"
)
BUSY = m(
    "pedestrian adult 14, elderly person 1.5, pedestrian child 2, delivery worker 1, police officer 0.3, "
    "wheelchair user 0.3"
)
STROLLERS = m("pedestrian adult 8, jogger 2, dog 2, stroller 1.5, pedestrian child 1.5, elderly person 1")
EUROPEAN_CARS = m("hatchback car 6, sedan 3, suv 3, van 1.5, electric car 0.8, motorcycle 0.6")
AMERICAN_CARS = m("suv 5, sedan 4, pickup truck 3, hatchback car 1, van 1, minivan 1")
SMALL_CARS = m("hatchback car 5, sedan 4, minivan 2, van 1.5, taxi 1")
EUROPEAN_KERB = m(
    "bollard 4, trash bin 2, bicycle 3, bicycle parking 1, no parking sign 1, street cabinet 1, parking meter 1, "
    "postbox 0.4"
)
AMERICAN_KERB = m(
    "fire hydrant 1.5, mailbox 1, parking meter 3, trash bin 2, stop sign 0.8, newspaper stand 1.2, utility pole "
    "0.6, street cabinet 0.6"
)
ASIAN_KERB = m(
    "utility pole 1, trash bin 1, bollard 2, traffic cone 1.5, street cabinet 1, bicycle 2, motorcycle 2, scooter 1"
)
SHOP_WALL = m(
    "advertising board 3, potted plant 3, chair 1.5, trash bin 0.7, storage box 1.5, plant pot 1.5, bench 1, "
    "vending machine 0.3"
)
HOME_WALL = m("potted plant 3, plant pot 3, trash bin 2, bicycle 2, storage box 0.6, bench 0.4, flower 1, stroller 0.3")
POOR_WALL = m(
    "storage box 4, barrel or bucket 2, garbage bag 3, chair 2, stool 2, table 1, plant pot 0.6, vehicle wheel "
    "1, mattress 0.3"
)
EUROPEAN_TRAFFIC = m("hatchback car 4, sedan 2, van 1.5, bus 0.5, cyclist 2, taxi 1, motorcycle rider 0.6")
AMERICAN_TRAFFIC = m("sedan 3, suv 4, pickup truck 2, bus 0.6, truck 0.6, taxi 0.7, cyclist 0.4")
