"""The set-point leaves: the ``Vehicle`` protocol and its backends."""
