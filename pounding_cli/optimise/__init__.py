"""The search of `pound optimise`: which points to look at next, from the values of those before."""
