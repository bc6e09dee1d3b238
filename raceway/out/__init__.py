"""How an answer is shown, written once for all: tables, pages, progress.

table      rows and sections on a screen;  wrapping: lines that end between words
page       one HTML page that opens without a network
progress   the bar on standard error
"""
