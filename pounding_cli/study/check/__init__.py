"""What is doubtful in a study, and what `pound check` says of it."""
