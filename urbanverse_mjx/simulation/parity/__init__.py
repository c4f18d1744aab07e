"""C MuJoCo as the reference: drives of one robot there and in an engine, and how far the two part."""
