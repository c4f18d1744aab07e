"""Cities of Asia: profiles and their reasons."""

from .mixes import BUSY, POOR_WALL, WALKERS
from .profile import CityProfile
from .profile import mix as m

PROFILES = (
    CityProfile(
        continent="Asia",
        country="China",
        city="Beijing",
        road=7.0,
        left=3.2,
        right=2.8,
        kerb=0.15,
        bends=(3.0,),
        side_streets=3,
        crosswalks=3,
        lane=1.5,
        houses=m(
            "apartment building#2 2, gatehouse#1 1.5, restaurant#1 1, pastry shop#1 1, clothing store#1 1, "
            "bookstore#0 1, cafe#1 1, retail#0 2"
        ),
        height=(4.5, 10.0),
        frontage=(7.0, 12.0),
        gaps=0.2,
        parked_left=0.6,
        parked_right=0.15,
        parked=m("sedan 5, suv 3, electric car 2, tricycle#1 2, minivan 1"),
        on_pavement=2,
        traffic=m("sedan 3, tricycle#1 2, electric scooter rider 4, cyclist 3, bus 0.4, taxi 1"),
        moving=5,
        kerbside=m("bicycle 8, scooter 2, trash bin 2, bollard 2, guard rail#1 1, street cabinet 1"),
        furniture=16,
        wallside=m(
            "bicycle 4, stool 2, potted plant 3, chair 2, storage box 2, tricycle#2 1, bonsai 0.5, garbage bag 1"
        ),
        clutter=14,
        people=m("pedestrian adult 9, elderly person 4, pedestrian child 1.5, delivery worker 1"),
        crowd=9,
        groups=m("cluster bicycle 6, cluster scooter 2, display 2, seats 2, row guard rail#1 2, planters 2, stalls 1"),
        hung=m("lantern#1 6, awning#0 1, banner 2, air conditioner 3"),
        hangings=18,
        trees=m("broad 2, wide 1, street 1"),
        spacing=8.0,
        asphalt=m("asphalt_used 2, asphalt_old 1"),
        paving=m("flags_grey 2, blocks_grey 1, flags_charcoal 1"),
        open_ground="earth",
        skies=m("spring_morning-smog 2, autumn_noon-hazy 1"),
        reason="A hutong edge: grey and red low fronts and gates, rows of shared bicycles, three-wheelers and "
        "e-bikes, railings, "
        "old scholar trees close together shading the street, hazy sky.",
    ),
    CityProfile(
        continent="Asia",
        country="China",
        city="Shijiazhuang",
        way="drive",
        road=11.0,
        left=4.8,
        right=4.4,
        kerb=0.15,
        verge=1.3,
        bends=(),
        side_streets=2,
        crosswalks=2,
        lane=1.8,
        houses=m(
            "apartment building#2 5, office building#2 2, supermarket 1, pharmacy#0 1, electronics store 1, "
            "bank#2 1, apartment building#0 1"
        ),
        height=(16.0, 30.0),
        frontage=(11.0, 16.0),
        parked_left=0.3,
        parked_right=0.3,
        parked=m("sedan 5, suv 4, electric car 1, van 1"),
        on_pavement=5,
        traffic=m("sedan 4, suv 3, bus 1, taxi 1, electric scooter rider 4, truck 0.5"),
        moving=6,
        kerbside=m("scooter 4, bicycle 4, trash bin 2, guard rail#1 3, street cabinet 1, bollard 1"),
        furniture=14,
        wallside=m("scooter 3, storage box 3, advertising board 2, potted plant 1, vending machine 0.5, stool 1"),
        clutter=9,
        people=WALKERS,
        crowd=7,
        groups=m("cluster scooter 6, row guard rail#1 4, row bollard 2, stalls 1, bus stop 2, spread street light 1"),
        hung=m("air conditioner 8, banner 3"),
        hangings=22,
        trees=m("slim 3, street 1"),
        spacing=7.5,
        asphalt=m("asphalt_new 2, asphalt_used 1"),
        paving=m("blocks_running 2, tactile_bars_yellow 0.6, flags_mixed 1"),
        open_ground="grass_dry",
        skies=m("winter_noon-smog 2, autumn_morning-hazy 1"),
        reason="An industrial capital of wide straight roads: grey slab blocks of six to ten storeys with air "
        "conditioners, poplars in "
        "verges, railings between lanes and walks, cars and e-scooters on wide block-paved pavements, smog.",
    ),
    CityProfile(
        continent="Asia",
        country="India",
        city="New Delhi",
        drives="left",
        road=7.5,
        left=2.4,
        right=2.0,
        kerb=0.2,
        bends=(-7.0, 6.0),
        side_streets=3,
        crosswalks=3,
        lane=1.4,
        blocked=1,
        houses=m(
            "clothing store#2 1, jewelry store 1, electronics store#1 1, restaurant#0 1, apartment building#0 2, "
            "photography shop 1, optical store 1, retail#2 2, pharmacy#2 1, watch shop 1"
        ),
        height=(7.0, 14.0),
        frontage=(5.0, 9.0),
        parked_left=0.6,
        parked_right=0.6,
        parked=m("motorcycle 8, hatchback car 3, scooter 2, rickshaw 2, suv 1"),
        on_pavement=3,
        traffic=m("rickshaw 5, motorcycle rider 5, hatchback car 2, cow 0.8, tricycle#1 2, bus 0.3, handcart 1"),
        moving=9,
        kerbside=m(
            "motorcycle 5, utility pole 2, transformer tower 0.1, cow 0.7, dog 1.5, debris 1, rock 1, barrel or "
            "bucket 1"
        ),
        furniture=15,
        wallside=POOR_WALL,
        clutter=18,
        people=BUSY,
        crowd=20,
        groups=m(
            "vendors 5, display 4, rubbish 4, cluster motorcycle 4, cluster rickshaw 2, terrace 1, spread "
            "utility pole 1"
        ),
        hung=m("banner 3, pennant#1 2, advertising board#3 2, awning 3, air conditioner 5, lantern 1"),
        hangings=28.0,
        trees=m("wide 1"),
        spacing=30.0,
        asphalt=m("asphalt_old-patched 1, asphalt_bleached-sanded 1"),
        paving=m("concrete_warm-sanded 1, sandstone-worn 2"),
        open_ground="earth",
        skies=m("winter_morning-smog 2, summer_noon-hazy 1"),
        reason="A bazaar street: auto-rickshaws, motorcycles in rows, cows and dogs at large, hand-painted signs "
        "over narrow shops, "
        "goods on the pavement of red sandstone, left-hand traffic, kerbs of 20 cm, smog.",
    ),
    CityProfile(
        continent="Asia",
        country="Japan",
        city="Tokyo",
        drives="left",
        road=4.8,
        left=2.3,
        right=2.1,
        kerb=0.1,
        bends=(4.0, -5.0),
        side_streets=4,
        crosswalks=4,
        lane=1.4,
        houses=m(
            "video game store 1.5, comic shop 1.5, convenience store#1 2, bubble tea bar 1, office building#2 2, "
            "apartment building#2 2, massage shop#2 1, "
            "electronics store#0 1, restaurant#2 1, cosmetics store 1, optical store#1 1"
        ),
        height=(6.0, 20.0),
        frontage=(5.0, 8.5),
        parked_left=0.06,
        parked_right=0.06,
        parked=m("minivan 3, hatchback car 2, van 2, taxi 1"),
        on_pavement=0,
        traffic=m("taxi 2, hatchback car 2, minivan 2, cyclist 3, truck 0.5"),
        moving=2.5,
        kerbside=m("utility pole 3, traffic cone 2, bicycle 5, bollard 4, guard rail#1 2, caution sign 0.7"),
        furniture=17,
        wallside=m(
            "vending machine 5, bicycle 5, potted plant 4, advertising board 4, plant pot 2, umbrella 0.7, "
            "storage box 1"
        ),
        clutter=26,
        people=m("pedestrian adult 12, elderly person 3, cyclist 0.6, delivery worker 1"),
        crowd=9,
        groups=m(
            "cluster bicycle 5, row bollard 2, row guard rail#1 2, cluster vending machine 3, works 1, "
            "spread utility pole 1, planters 4"
        ),
        hung=m("banner#1 3, banner#0 2, lantern#1 5, air conditioner 5, awning#0 1, advertising board#3 2"),
        hangings=34.0,
        trees=m("slim 1"),
        spacing=0.0,
        asphalt=m("asphalt_used 2, asphalt_new 1"),
        paving=m("tactile_bars_yellow 1, blocks_grey 2, asphalt_grey 1"),
        open_ground="gravel",
        skies=m("spring_morning-broken_cumulus 1, autumn_morning-thin_overcast 2"),
        reason="A side street of a shopping quarter: narrow fronts from two to six storeys with banners, utility "
        "poles on the walk, "
        "vending machines, bicycles, cones; almost no kerb parking (a proof of a parking place is needed), "
        "left-hand traffic, clean.",
    ),
    CityProfile(
        continent="Asia",
        country="Japan",
        city="Kyoto",
        drives="left",
        road=4.4,
        left=2.1,
        right=2.0,
        kerb=0.08,
        bends=(-3.0,),
        side_streets=3,
        crosswalks=3,
        lane=1.4,
        houses=m(
            "house#2 1, cabin#0 2, cabin#2 3, pub#1 2, gatehouse#2 1, massage shop#0 1, shrine#0 0.7, pastry "
            "shop#1 1, tobacco shop#2 1"
        ),
        height=(4.0, 7.5),
        frontage=(5.0, 8.0),
        gaps=0.15,
        parked_left=0.03,
        parked_right=0.05,
        parked=m("minivan 2, hatchback car 2, bicycle 3"),
        on_pavement=0,
        traffic=m("taxi 2, rickshaw 1, cyclist 3, minivan 1"),
        moving=2,
        kerbside=m("bicycle 3, bollard 2, guard stone 3, utility pole 1, stone block 1, plant pot 1"),
        furniture=11,
        wallside=m(
            "bonsai 3, potted plant 5, plant pot 3, lantern 1, bench 1.5, advertising board 1, umbrella 1, "
            "barrel or bucket 1, vending machine 1"
        ),
        clutter=20,
        people=m("pedestrian adult 12, elderly person 3, pedestrian child 1, police officer 0.3"),
        crowd=11,
        groups=m("planters 5, cluster bicycle 2, seats 1, cafe 1, spread lamppost 1"),
        hung=m("lantern#1 10, lantern#0 5, banner#1 1, awning#0 0.5, pennant#0 3"),
        hangings=32.0,
        trees=m("blossom 3, street 1"),
        spacing=13.0,
        asphalt=m("asphalt_used 1, setts_granite 1"),
        paving=m("granite_light 2, slate 1"),
        open_ground="gravel",
        skies=m("spring_morning-few_cumulus 2, autumn_afternoon-clear 1"),
        reason="An old quarter: low dark timber houses, lanterns and cloth signs, cherry trees, pots and guard "
        "stones, stone paving "
        "level with the road, hardly a car; many visitors on foot.",
    ),
    CityProfile(
        continent="Asia",
        country="Kazakhstan",
        city="Almaty",
        road=8.0,
        left=5.0,
        right=4.6,
        kerb=0.17,
        verge=2.2,
        bends=(3.0,),
        side_streets=2,
        crosswalks=2,
        lane=1.8,
        houses=m(
            "apartment building#0 3, apartment building#3 2, apartment building#2 2, pharmacy#2 1, supermarket#0 "
            "1, school#1 0.6"
        ),
        height=(12.0, 17.0),
        frontage=(11.0, 17.0),
        gaps=0.2,
        parked_left=0.5,
        parked_right=0.5,
        parked=m("suv 4, sedan 5, taxi 1, minivan 1"),
        on_pavement=2,
        traffic=m("suv 3, sedan 3, bus 1, taxi 1"),
        moving=3,
        kerbside=m("trash bin 2, bench 1.5, street cabinet 1, traffic sign 1, parking meter 0.5"),
        furniture=10,
        wallside=m("bench 3, trash bin 2, potted plant 1, flower 2, bicycle 1, storage box 1"),
        clutter=7,
        people=WALKERS,
        crowd=6,
        groups=m("seats 4, row fence#1 3, stalls 1, bus stop 2, spread street light 1"),
        hung=m("air conditioner 6, awning 1"),
        hangings=10,
        trees=m("broad 3, slim 3, wide 1"),
        spacing=6.5,
        asphalt=m("asphalt_old 1, asphalt_old-patched 1"),
        paving=m("asphalt_grey 1, flags_square-worn 1, blocks_autumn 1"),
        open_ground="grass",
        skies=m("spring_noon-crisp 2, summer_morning-clear 1"),
        reason="Soviet blocks of four to five storeys behind rows of poplars, elms and irrigation ditches; broad "
        "green verges, "
        "benches, large cars, mountain air.",
    ),
    CityProfile(
        continent="Asia",
        country="Singapore",
        city="Singapore",
        drives="left",
        road=8.0,
        left=3.2,
        right=3.6,
        kerb=0.14,
        verge=1.2,
        bends=(5.0,),
        side_streets=2,
        crosswalks=3,
        lane=1.6,
        houses=m(
            "travel agency 1, pastry shop#0 1, flower shop#2 1.5, clothing store#2 1.5, cosmetics store#0 1, "
            "cafe#2 1.5, bistro#0 1, tattoo shop#2 0.5, skyscraper 0.4"
        ),
        height=(8.0, 13.0),
        frontage=(5.5, 8.5),
        parked_left=0.3,
        parked_right=0.2,
        parked=m("sedan 4, hatchback car 3, suv 2, taxi 2, van 1"),
        on_pavement=0,
        traffic=m("sedan 3, taxi 3, bus 1, motorcycle rider 1, van 1"),
        moving=4,
        kerbside=m("trash bin 3, bollard 3, street cabinet 1, no parking sign 1, bicycle rental 0.2, fire hydrant 1"),
        furniture=12,
        wallside=m(
            "potted plant 5, advertising board 2, table#1 1.5, chair 3, plant pot 2, bench 1, vending machine 0.7"
        ),
        clutter=14,
        people=BUSY,
        crowd=9,
        groups=m("cafe 4, planters 5, terrace 2, bus stop 1, spread lamppost 1, seats 1"),
        hung=m("awning 5, banner 2, lantern#1 1, air conditioner 1"),
        hangings=20,
        trees=m("broad 3, palm 3, wide 1"),
        spacing=8.0,
        asphalt=m("asphalt_new 1"),
        paving=m("granite_courses 1, flags_rose 1, concrete_exposed 1"),
        open_ground="grass",
        skies=m("summer_noon-towering_cumulus 2, summer_afternoon-broken_cumulus 1"),
        reason="Shophouses in pastel colours with covered walks, rain trees and palms in green verges, left-hand "
        "traffic, hawker "
        "tables, tidy bins; towering tropical clouds.",
    ),
    CityProfile(
        continent="Asia",
        country="South Korea",
        city="Seoul",
        road=5.4,
        left=2.0,
        right=1.8,
        kerb=0.1,
        bends=(-6.0, 7.0),
        side_streets=4,
        crosswalks=3,
        lane=1.4,
        houses=m(
            "convenience store#1 2, cosmetics store 2, cafe#1 1, bar#2 1, internet cafe 1.5, fast food "
            "restaurant#1 0.6, apartment building#1 2, office building#0 1, hair salon#1 1, video game "
            "store#1 1"
        ),
        height=(7.0, 17.0),
        frontage=(6.0, 10.0),
        parked_left=0.3,
        parked_right=0.2,
        parked=m("sedan 4, suv 3, van 1, scooter 2, motorcycle 1"),
        on_pavement=2,
        traffic=m("sedan 3, taxi 2, motorcycle rider 3, van 1, bus 0.3"),
        moving=3,
        kerbside=m(
            "utility pole 2, scooter 4, bollard 3, trash bin 0.6, garbage bag 2, traffic cone 1, street cabinet 1"
        ),
        furniture=17,
        wallside=m(
            "advertising board 6, vending machine 1.5, potted plant 2, garbage bag 3, storage box 2, scooter 1, "
            "chair 1, stool 1.5"
        ),
        clutter=22,
        people=BUSY,
        crowd=13,
        groups=m("cluster scooter 3, stalls 2, terrace 2, rubbish 3, display 2, spread utility pole 1, row bollard 2"),
        hung=m("banner#0 3, banner#1 3, advertising board#3 3, air conditioner 5, lantern 1, awning#0 1"),
        hangings=34.0,
        trees=m("street 1, street 1"),
        spacing=22.0,
        asphalt=m("asphalt_used 1, lane_red-painted_red_worn 0.3"),
        paving=m("blocks_running 2, blocks_autumn 1"),
        open_ground="earth",
        skies=m("autumn_noon-clear 1, winter_noon-hazy 1"),
        reason="A student quarter: brick and glass buildings of three to five storeys covered with vertical "
        "signs, delivery scooters, "
        "hire scooters left anywhere, sandwich boards, tent bars and rubbish bags on block-paved walks.",
    ),
    CityProfile(
        continent="Asia",
        country="Vietnam",
        city="Ho Chi Minh City",
        road=6.8,
        left=2.6,
        right=2.4,
        kerb=0.13,
        bends=(6.0, -5.0),
        side_streets=4,
        crosswalks=3,
        lane=1.4,
        blocked=1,
        houses=m(
            "flower shop#0 1, pharmacy#2 1, hair salon#2 1, cafe#2 1, e-cigarette store 1, juice bar 1, "
            "photography shop#0 1, clothing store#2 1, hotel#2 1, bakery#1 1, convenience store#0 1"
        ),
        height=(9.0, 18.0),
        frontage=(4.5, 6.0),
        parked_left=0.3,
        parked_right=0.3,
        parked=m("motorcycle 10, hatchback car 1, taxi 1, scooter 3"),
        on_pavement=0,
        traffic=m("motorcycle rider 12, electric scooter rider 2, taxi 1, tricycle#1 1, cyclist 1, van 0.5"),
        moving=14,
        kerbside=m("motorcycle 12, utility pole 2, plant pot 1, stool 1, trash bin 0.5, barrel or bucket 1"),
        furniture=24,
        wallside=m("motorcycle 6, stool 5, table#0 2, storage box 3, potted plant 3, barrel or bucket 1, lantern 0.5"),
        clutter=22,
        people=BUSY,
        crowd=12,
        groups=m("terrace 6, cluster motorcycle 10, vendors 3, stalls 1, spread utility pole 1, planters 2"),
        hung=m("awning 5, banner 4, air conditioner 4, lantern#1 1"),
        hangings=32,
        trees=m("broad 1, wide 1, palm 1"),
        spacing=14.0,
        asphalt=m("asphalt_old 1, asphalt_used-stained 1"),
        paving=m("terracotta 1, blocks_hexagon_colours 1, flags_checks 1"),
        open_ground="earth",
        skies=m("summer_noon-broken_cumulus 2, summer_morning-hazy 1"),
        reason="Tube houses four to five metres wide and four storeys high; rows of motorcycles on every "
        "pavement, street kitchens "
        "with low stools, poles with bundles of wires, streams of riders.",
    ),
)
