//! Models of the field: what is read, what is refused and by which name, what is left out and said so.
