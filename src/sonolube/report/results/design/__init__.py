"""Results of design as text, JSON and tables of pages: studies, maps, control, optimum, plans, uncertainty."""
