"""Built-in reports.

pictures   orbit, spectrum and ball loads as PNG files
"""
