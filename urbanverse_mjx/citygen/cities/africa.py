"""Cities of Africa: profiles and their reasons."""

from .mixes import BUSY, EUROPEAN_CARS, POOR_WALL, SHOP_WALL
from .profile import CityProfile
from .profile import mix as m

PROFILES = (
    CityProfile(
        continent="Africa",
        country="Egypt",
        city="Cairo",
        road=8.5,
        left=2.6,
        right=2.2,
        kerb=0.21,
        bends=(5.0, -7.0),
        side_streets=3,
        crosswalks=3,
        lane=1.4,
        blocked=1,
        houses=m(
            "apartment building#0 7, apartment building#3 2, cafe#0 1, bakery#0 1, bookstore#2 1, restaurant#0 "
            "1, tobacco shop#2 1"
        ),
        height=(15.0, 27.0),
        frontage=(9.0, 15.0),
        parked_left=0.9,
        parked_right=0.85,
        parked=m("sedan 6, hatchback car 3, minivan 2, taxi 1.5, motorcycle 1.5"),
        on_pavement=4,
        traffic=m("taxi 3, sedan 3, minivan 2, motorcycle rider 2, tricycle 1, donkey 0.4"),
        moving=6,
        kerbside=m(
            "bollard 1, traffic cone 1, street cabinet 1, trash bin 0.6, motorcycle 2, utility pole 0.6, debris "
            "1, rock 1"
        ),
        furniture=9,
        wallside=m(
            "chair 4, table#0 2, storage box 3, barrel or bucket 2, garbage bag 4, refrigerator 0.6, stool 2, "
            "plant pot 0.5"
        ),
        clutter=20,
        people=BUSY,
        crowd=14,
        groups=m("vendors 4, rubbish 6, cafe 2, display 2, stalls 1, cluster motorcycle 2, spread street light 1"),
        hung=m("air conditioner 6, awning#0 2, banner 2, surveillance camera 0.3"),
        hangings=26,
        trees=m("street 2, palm 1"),
        spacing=34.0,
        asphalt=m("asphalt_bleached-sanded 2, asphalt_bleached-cracked 1"),
        paving=m("concrete_warm-sanded 2, concrete_ochre-cracked 1"),
        open_ground="earth",
        skies=m("summer_noon-hazy 2, summer_afternoon-smog 1"),
        reason="Downtown: five to eight storeys of sand-coloured plaster with air conditioners, pavements of 2 "
        "to 3 m with "
        "kerbs near 20 cm, cars parked along both kerbs and on them, chairs of tea houses, carts, rubbish; dust "
        "and haze.",
    ),
    CityProfile(
        continent="Africa",
        country="Kenya",
        city="Nairobi",
        drives="left",
        way="drive",
        road=9.5,
        left=3.6,
        right=3.0,
        kerb=0.16,
        verge=1.4,
        bends=(-6.0,),
        side_streets=2,
        crosswalks=2,
        lane=1.4,
        houses=m(
            "retail#2 2, retail#1 1, office building#2 2, hardware store 1, supermarket#2 1, bank#1 1, butcher "
            "shop#0 1, "
            "hair salon#0 1, apartment building#3 2"
        ),
        height=(5.0, 16.0),
        frontage=(7.0, 15.0),
        gaps=0.2,
        parked_left=0.25,
        parked_right=0.3,
        parked=m("van 4, sedan 2, suv 2, hatchback car 2, motorcycle 2"),
        on_pavement=2,
        traffic=m("van 4, bus 2, sedan 2, motorcycle rider 3, suv 2, truck 1, handcart 0.6"),
        moving=6,
        kerbside=m("utility pole 2, rock 2, bollard 1, advertising board 2, trash bin 0.5, motorcycle 1.5, stone 1"),
        furniture=10,
        wallside=POOR_WALL,
        clutter=13,
        people=BUSY,
        crowd=14,
        groups=m("stalls 4, vendors 3, cluster motorcycle 2, rubbish 2, bus stop 2, works 1, spread utility pole 1"),
        hung=m("banner 5, awning 2"),
        hangings=9,
        trees=m("wide 2, blossom 1, round 1"),
        spacing=17.0,
        asphalt=m("asphalt_old-patched 2, asphalt_bleached 1"),
        paving=m("blocks_grey 2, blocks_running 1, blocks_grey-worn 1"),
        open_ground="earth",
        skies=m("spring_morning-scattered_cumulus 2, autumn_noon-towering_cumulus 1"),
        reason="One drives on the left; matatu vans and boda motorcycles rule the kerb; broad red-earth verges "
        "with jacarandas, "
        "cabro-block walks, one- to five-storey shops with painted signs, hawkers and kiosks on the walk.",
    ),
    CityProfile(
        continent="Africa",
        country="Morocco",
        city="Tangier",
        road=5.2,
        left=2.4,
        right=2.1,
        kerb=0.14,
        bends=(9.0, -10.0, 8.0),
        side_streets=3,
        crosswalks=3,
        lane=1.4,
        blocked=1,
        houses=m(
            "apartment building#2 3, clothing store#0 2, pharmacy#0 2, hair salon#0 1, hotel#2 2, cafe#2 1, "
            "convenience store#0 1"
        ),
        height=(8.0, 14.0),
        frontage=(5.5, 9.0),
        parked_left=0.5,
        parked_right=0.1,
        parked=m("hatchback car 4, taxi 2, motorcycle 2, scooter 1, van 0.6"),
        on_pavement=2,
        traffic=m("taxi 2, hatchback car 2, motorcycle rider 1, donkey 0.7, handcart 1"),
        moving=3,
        kerbside=m("bollard 3, motorcycle 2, plant pot 1, street cabinet 1, cat 1.2"),
        furniture=7,
        wallside=m(
            "chair 3, table#1 1.5, storage box 2, barrel or bucket 2, plant pot 2, potted plant 2, cat 1.5, stool 1"
        ),
        clutter=20,
        people=BUSY,
        crowd=13,
        groups=m("display 5, vendors 3, cafe 4, rubbish 2, planters 2"),
        hung=m("awning 3, banner 1, lantern 3, air conditioner 1"),
        hangings=20,
        trees=m("palm 1"),
        spacing=45.0,
        asphalt=m("setts_blocks 1, asphalt_bleached-cracked 1"),
        paving=m("tiles_black_white 2, flags_white 2, limestone_polished-stained 1"),
        open_ground="earth",
        skies=m("summer_morning-few_cumulus 2, spring_noon-clear 1"),
        reason="White plaster houses of two to four storeys along narrow bending streets up from the port; "
        "goods, tables and cats "
        "on tiled pavements hardly wider than one person, a blocked one now and then.",
    ),
    CityProfile(
        continent="Africa",
        country="Morocco",
        city="Rabat",
        road=8.0,
        left=4.2,
        right=4.6,
        kerb=0.15,
        bends=(4.0,),
        side_streets=2,
        crosswalks=3,
        lane=1.6,
        houses=m(
            "apartment building#2 3, apartment building#0 2, bank#1 1, hotel#2 2, pharmacy#0 1, cafe#2 1, office "
            "building#2 1"
        ),
        height=(12.0, 19.0),
        frontage=(9.0, 14.0),
        parked_left=0.7,
        parked_right=0.6,
        parked=m("hatchback car 5, sedan 2, suv 1, taxi 1.5"),
        on_pavement=1,
        traffic=m("taxi 2, hatchback car 3, bus 0.5, motorcycle rider 1"),
        moving=3,
        kerbside=m("trash bin 2, bench 1, no parking sign 1, street cabinet 1, bollard 2, parking meter 1"),
        furniture=12,
        wallside=SHOP_WALL,
        clutter=12,
        people=BUSY,
        crowd=9,
        groups=m("cafe 6, planters 2, seats 2, spread lamppost 1, display 1"),
        hung=m("awning 4, banner 1, air conditioner 1"),
        hangings=12,
        trees=m("palm 4"),
        spacing=8.5,
        asphalt=m("asphalt_used 2, asphalt_bleached 1"),
        paving=m("flags_red_checks 2, flags_buff 1, flags_rose 1"),
        open_ground="grass_dry",
        skies=m("spring_noon-clear 2, summer_noon-cirrus 1"),
        reason="The French new town: straight avenues lined with palms, white and cream blocks with arcades and "
        "cafe terraces, red "
        "and cream tiled pavements of four metres, orderly parking.",
    ),
    CityProfile(
        continent="Africa",
        country="Nigeria",
        city="Lagos",
        way="drive",
        road=7.6,
        left=2.6,
        right=2.4,
        kerb=0.18,
        bends=(6.0, 5.0),
        side_streets=3,
        crosswalks=2,
        lane=1.4,
        blocked=1,
        houses=m(
            "retail 3, hardware store#1 1, photography shop 1, copy shop or print shop 1, tobacco shop 1, "
            "house#1 1, butcher shop 1, apartment building#3 2, retail#2 2"
        ),
        height=(4.0, 11.0),
        frontage=(6.0, 13.0),
        gaps=0.25,
        parked_left=0.35,
        parked_right=0.4,
        parked=m("van 3, minivan 3, sedan 3, suv 1, tricycle#1 2, motorcycle 2"),
        on_pavement=3,
        traffic=m("minivan 3, van 3, rickshaw 3, motorcycle rider 4, sedan 2, truck 1"),
        moving=8,
        kerbside=m(
            "utility pole 2, transformer tower 0.15, rock 1, debris 2, vehicle wheel 2, barrel or bucket 2, "
            "advertising board 2"
        ),
        furniture=14,
        wallside=POOR_WALL,
        clutter=20,
        people=BUSY,
        crowd=22,
        groups=m(
            "vendors 6, stalls 3, rubbish 5, cluster motorcycle 2, cluster rickshaw 2, display 2, spread utility "
            "pole 1, works 1"
        ),
        hung=m("banner 5, awning 3"),
        hangings=14,
        trees=m("palm 1, wide 1"),
        spacing=40.0,
        asphalt=m("asphalt_brown-sanded 2, asphalt_old-patched 1"),
        paving=m("concrete_grey-cracked 2, concrete_warm-sanded 1"),
        open_ground="earth",
        skies=m("summer_noon-towering_cumulus 1, summer_morning-thin_overcast 2"),
        reason="Crowds and vendors fill the edge of the road, yellow danfo vans and three-wheelers stop "
        "anywhere; low shops of "
        "blocks and sheet under masses of wires, open drains, debris and puddles; humid haze or thunder clouds.",
    ),
    CityProfile(
        continent="Africa",
        country="South Africa",
        city="Cape Town",
        drives="left",
        road=9.0,
        left=3.4,
        right=3.8,
        kerb=0.15,
        bends=(-4.0, 6.0),
        side_streets=2,
        crosswalks=3,
        lane=1.6,
        houses=m(
            "bar#1 2, pub#0 2, clothing store#0 2, cafe#2 2, restaurant#0 1, hotel#2 2, bookstore#1 1, pastry "
            "shop 1, flower shop#2 1"
        ),
        height=(7.0, 13.0),
        frontage=(7.0, 12.0),
        parked_left=0.6,
        parked_right=0.55,
        parked=EUROPEAN_CARS,
        on_pavement=0,
        traffic=m("hatchback car 3, sedan 2, van 2, suv 2, pickup truck 2, bus 0.3"),
        moving=3,
        kerbside=m("bollard 4, trash bin 2, parking meter 1, fire hydrant 1, bicycle 1, security guard 1"),
        furniture=13,
        wallside=SHOP_WALL,
        clutter=11,
        people=m("pedestrian adult 9, security guard 1, jogger 1, dog 1, pedestrian child 1"),
        crowd=8,
        groups=m("cafe 4, planters 3, seats 1, stalls 1, spread lamppost 1"),
        hung=m("awning 5, banner 1"),
        hangings=16,
        trees=m("wide 2, palm 1"),
        spacing=16.0,
        asphalt=m("asphalt_used 2, asphalt_old 1"),
        paving=m("brick_red_herringbone 2, brick_mixed 1, flags_square 1"),
        open_ground="grass",
        skies=m("summer_afternoon-clear 1, summer_noon-few_cumulus 2"),
        reason="Long Street and Bree Street: two-storey Victorian fronts with verandas over the walk, brick "
        "paving, left-hand "
        "traffic, car guards, bollards; clear southern light.",
    ),
)
