"""A frame becomes a 3-D pose: BlazePose on LiteRT, then lifting by depth."""
