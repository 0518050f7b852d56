"""Teaching gestures of one's own: what to tell whoever shows them, and models that learn on."""
