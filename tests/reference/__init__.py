"""Second methods, written from the paper's equations alone, that the solver is checked against."""
