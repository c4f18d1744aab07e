"""What recipes of several folders share: sizes, outlines, soft and painted shapes, images of fronts."""
