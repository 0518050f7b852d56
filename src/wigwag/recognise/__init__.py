"""A clip becomes a gesture: the Heavy and Encoded recognisers."""
