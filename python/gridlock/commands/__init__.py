"""Commands of ``gridlock`` that are programs of their own: the module ``gridlock.commands.plot`` is the program ``gridlock-plot``."""
