"""From a video, or a scene graph, to compiled digital cousins, stage by stage."""
