"""A clip becomes numbers: normalisation, embedding, scaling."""
