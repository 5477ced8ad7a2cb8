//! Every parameter at its limits and beyond, from the table of variables.
