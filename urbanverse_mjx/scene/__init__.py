"""Layout -> MJCF, ground prisms, maps, routes, episode tables; many compiled scenes -> one bank."""
