"""A page in the browser that shows a flight as it happens, and has a stop button; it cannot slow the loop."""
