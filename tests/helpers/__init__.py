"""What several folders of tests share: studies, plans, fakes and readers of what the program writes."""
