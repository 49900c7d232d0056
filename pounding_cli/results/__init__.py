"""Results: responses as arrays, one Dataset a study, its file, its tables."""
