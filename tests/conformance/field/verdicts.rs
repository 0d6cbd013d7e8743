//! Verdicts of the field: nothing wrong agrees, nothing right differs.
