"""The physics, law by law: one table of cases, and what each owes whoever uses it."""
