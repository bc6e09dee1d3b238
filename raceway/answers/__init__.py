"""How an answer is shown, written once for all: tables, pages, progress.

answer     what a public function answers: its screen, files and picture
quantities  every number that the product states, declared once
table      rows and sections on a screen, lines that end between words
picture    figures of matplotlib, without a window or on a caller's axes
page       one HTML page that opens without a network
progress   the bar on standard error
"""
