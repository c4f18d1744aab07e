"""Cities of North America: profiles and their reasons."""

from .mixes import AMERICAN_CARS, AMERICAN_TRAFFIC, BUSY, SHOP_WALL, STROLLERS, WALKERS
from .profile import CityProfile
from .profile import mix as m

PROFILES = (
    CityProfile(
        continent="North America",
        country="Canada",
        city="Toronto",
        road=9.0,
        left=3.2,
        right=3.4,
        kerb=0.15,
        bends=(),
        side_streets=2,
        crosswalks=3,
        lane=1.7,
        houses=m(
            "clothing store#1 2, hardware store#0 0.4, pub#2 1, restaurant#1 2, tattoo shop 1, convenience "
            "store#2 2, copy shop or print shop 1, bookstore#0 2, skyscraper#0 0.5"
        ),
        height=(8.0, 13.0),
        frontage=(6.0, 10.0),
        parked_left=0.55,
        parked_right=0.5,
        parked=AMERICAN_CARS,
        traffic=m("sedan 3, suv 3, tram#2 1, taxi 1, cyclist 2"),
        moving=4,
        kerbside=m(
            "utility pole 2, bicycle parking 2, newspaper stand 3, trash bin 2, bicycle 3, mailbox 1, fire "
            "hydrant 1, traffic cone 1"
        ),
        furniture=15,
        wallside=SHOP_WALL,
        clutter=12,
        people=WALKERS,
        crowd=9,
        groups=m("works 2, cluster bicycle 3, cafe 3, rubbish 2, display 2, spread utility pole 1, seats 1"),
        hung=m("awning 5, banner#1 2, air conditioner 1"),
        hangings=16,
        trees=m("street 2, street 1"),
        spacing=15.0,
        asphalt=m("asphalt_old-patched 1, asphalt_used-patched 1"),
        paving=m("concrete_pale 2, concrete_pale-patched 1"),
        open_ground="grass",
        skies=m("autumn_noon-scattered_cumulus 1, spring_noon-thin_overcast 1"),
        reason="Queen Street: brick shops of two to three storeys, streetcars, wooden poles, newspaper boxes, "
        "ring-and-post bicycle "
        "stands, patched asphalt, dig after dig; glass towers behind.",
    ),
    CityProfile(
        continent="North America",
        country="Mexico",
        city="Puerto Vallarta",
        road=6.4,
        left=2.0,
        right=1.8,
        kerb=0.2,
        bends=(7.0, -6.0),
        side_streets=3,
        crosswalks=3,
        lane=1.4,
        blocked=1,
        houses=m(
            "house#0 2, juice bar 1, bistro#2 1, hotel#2 1, ice cream shop 1, bungalow#0 1, travel agency#1 1, "
            "seafood shop#2 1, bar#1 2, tobacco shop#1 1, convenience store#1 1"
        ),
        height=(4.5, 9.5),
        frontage=(6.0, 10.0),
        parked_left=0.6,
        parked_right=0.45,
        parked=m("pickup truck 3, hatchback car 3, taxi 2, motorcycle 2, sedan 2"),
        on_pavement=1,
        traffic=m("taxi 3, pickup truck 2, bus 0.8, motorcycle rider 2, all-terrain vehicle 1"),
        moving=4,
        kerbside=m("utility pole 2, plant pot 2, bollard 1, trash bin 1, dog 1.5, guard stone 1"),
        furniture=10,
        wallside=m(
            "potted plant 5, chair 3, table#1 2, storage box 2, beach chair 1, surfboard 0.6, advertising board "
            "2, barrel or bucket 1"
        ),
        clutter=18,
        people=BUSY,
        crowd=10,
        groups=m("stalls 3, cafe 4, planters 4, display 2, vendors 1, spread utility pole 1"),
        hung=m("awning 6, pennant#1 4, banner 2, lantern 1"),
        hangings=22,
        trees=m("palm 3, blossom 1"),
        spacing=13.0,
        asphalt=m("cobbles_round 1"),
        paving=m("terracotta 1, concrete_warm 1, pebbles 1"),
        open_ground="earth",
        skies=m("summer_afternoon-few_cumulus 1, winter_noon-clear 1"),
        reason="Cobbled streets to the beach: low white houses with red roofs and colourful fronts, taco stands, "
        "palms and flowers, "
        "high broken kerbs, taxis and pickups.",
    ),
    CityProfile(
        continent="North America",
        country="United States",
        city="Los Angeles",
        way="drive",
        road=11.5,
        left=4.0,
        right=4.0,
        kerb=0.16,
        verge=1.5,
        yard=4.0,
        bends=(-4.0,),
        side_streets=2,
        crosswalks=2,
        lane=1.5,
        houses=m("bungalow 5, house#0 3, house#1 1, motel#0 0.3, apartment building#2 0.6, fast food restaurant 0.5"),
        height=(4.5, 7.5),
        frontage=(10.0, 15.0),
        gaps=0.6,
        parked_left=0.45,
        parked_right=0.45,
        parked=m("suv 5, pickup truck 4, sedan 4, convertible car 0.6, camper 0.5, sports car 0.5"),
        traffic=AMERICAN_TRAFFIC,
        moving=3,
        kerbside=m(
            "utility pole 1, mailbox 1, fire hydrant 1, trash bin 3, scooter 2, street cabinet 0.6, shopping cart 0.8"
        ),
        furniture=8,
        wallside=m("trash bin 3, plant pot 2, parcels 1, bicycle 1, shopping cart 0.7, tent 0.6, mattress 0.3"),
        clutter=5,
        people=STROLLERS,
        crowd=3,
        groups=m("cluster scooter 2, cluster trash bin 3, spread utility pole 1, bus stop 1, rubbish 1"),
        hung=(),
        hangings=0.0,
        trees=m("palm 3, palm 2, wide 0.6"),
        spacing=10.0,
        asphalt=m("asphalt_bleached-sealed 2, asphalt_bleached-cracked 1"),
        paving=m("concrete_pale 2, concrete_pale-cracked 1"),
        open_ground="grass_dry",
        skies=m("summer_morning-clear 1, summer_evening-hazy 1"),
        reason="A residential street: bungalows with front lawns, tall palms in the parkway, a very wide "
        "bleached road with large cars, "
        "bins in threes on the verge, hardly anybody on foot, low golden light.",
    ),
)
