"""Where k(speed) hardens or softens."""
