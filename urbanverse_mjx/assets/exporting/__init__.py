"""Assets for other tools: GLB, OBJ, MJCF and USD."""
