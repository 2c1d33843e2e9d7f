"""Commands of ``gridlock`` that carry out a study: the module ``gridlock_studies.commands.paper`` is the program ``gridlock-paper``."""
