"""From a tour, or a scene graph, to compiled digital cousins, stage by stage."""
